#include "common/mapped_file.h"

#include <sys/mman.h>

#include <algorithm>
#include <boost/interprocess/exceptions.hpp>
#include <boost/interprocess/file_mapping.hpp>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "common/input_file.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

MappedFile::MappedFile(const std::string& path) {
  namespace bi = boost::interprocess;
  requireRegularFile(path);
  std::error_code error;
  try {
    const bi::file_mapping file(path.c_str(), bi::read_only);
    // No empty range can be mapped.
    if (std::filesystem::file_size(path, error) == 0 && !error) return;
    region_ = bi::mapped_region(file, bi::read_only);
  } catch (const bi::interprocess_exception& failure) {
    throw Error(path, "", std::strerror(failure.get_native_error()));
  }
}

void MappedFile::forget(std::uint64_t offset, std::uint64_t count) const {
  const std::uint64_t page = boost::interprocess::mapped_region::get_page_size();
  const std::uint64_t first = offset / page * page, last = std::min<std::uint64_t>(offset + count, size());
  if (first >= last) return;
  madvise(static_cast<char*>(region_.get_address()) + first, last - first, MADV_DONTNEED);
}

}  // namespace saw_ndt::internal
