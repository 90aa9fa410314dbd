#include "common/input_file.h"

#include <cerrno>
#include <cstring>
#include <system_error>

#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

void requireRegularFile(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (error) throw Error(path.string(), "", error.message());
  if (std::filesystem::is_directory(status)) throw Error(path.string(), "", std::strerror(EISDIR));
  if (!std::filesystem::is_regular_file(status)) throw Error(path.string(), "", "is no regular file");
}

std::ifstream openInputFile(const std::filesystem::path& path) {
  requireRegularFile(path);
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw Error(path.string(), "", errno != 0 ? std::strerror(errno) : "cannot be opened");
  return stream;
}

}  // namespace saw_ndt::internal
