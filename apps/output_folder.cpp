#include "output_folder.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "saw_ndt/common/error.h"

namespace saw_ndt {

OutputFolder::OutputFolder(const std::string& path) : path_(path) {
  std::error_code error;
  made_ = std::filesystem::create_directories(path_, error);
  if (error) throw Error(path, "", "the output folder cannot be made: " + error.message());
  if (!std::filesystem::is_directory(path_)) throw Error(path, "", "is not a folder");
  if (::access(path.c_str(), W_OK | X_OK) != 0) {
    throw Error(path, "", std::string("the output folder cannot be written: ") + std::strerror(errno));
  }
}

OutputFolder::~OutputFolder() {
  if (!made_ || kept_) return;
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace saw_ndt
