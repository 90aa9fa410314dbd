#include "common/input_file.h"

#include <cerrno>
#include <cstring>

#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

std::ifstream openInputFile(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw Error(path.string(), "", std::strerror(EISDIR));
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw Error(path.string(), "", errno != 0 ? std::strerror(errno) : "cannot be opened");
  return stream;
}

}  // namespace saw_ndt::internal
