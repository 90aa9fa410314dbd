#include "output_folder.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "saw_ndt/common/error.h"

namespace saw_ndt {

namespace {

/// The first folder on the way to `path` that does not exist; empty where all do.
std::filesystem::path firstMissing(const std::filesystem::path& path) {
  std::filesystem::path so_far;
  std::error_code ignored;
  for (const std::filesystem::path& part : path) {
    so_far /= part;
    if (std::filesystem::symlink_status(so_far, ignored).type() == std::filesystem::file_type::not_found) return so_far;
  }
  return {};
}

}  // namespace

OutputFolder::OutputFolder(const std::string& path) : path_(path) {
  made_.emplace([&] {
    const std::filesystem::path missing = firstMissing(path_);
    std::error_code error;
    std::filesystem::create_directories(path_, error);
    if (error) {
      const std::string reason = error.message();
      if (!missing.empty()) std::filesystem::remove_all(missing, error);
      throw Error(path, "", "the output folder cannot be made: " + reason);
    }
    return missing;
  });
  std::error_code ignored;
  if (!std::filesystem::is_directory(path_, ignored)) throw Error(path, "", "is not a folder");
  if (::access(path.c_str(), W_OK | X_OK) != 0) {
    throw Error(path, "", std::string("the output folder cannot be written: ") + std::strerror(errno));
  }
}

}  // namespace saw_ndt
