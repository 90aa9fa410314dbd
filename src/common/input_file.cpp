#include "common/input_file.h"

#include <cerrno>
#include <cstring>
#include <string_view>
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

std::ifstream openTextFile(const std::filesystem::path& path) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  std::ifstream stream = openInputFile(path);
  char begin[kByteOrderMark.size()] = {};
  stream.read(begin, sizeof begin);
  if (std::string_view(begin, sizeof begin) == kByteOrderMark) return stream;
  stream.clear();  // of the end of a short file
  stream.seekg(0);
  return stream;
}

}  // namespace saw_ndt::internal
