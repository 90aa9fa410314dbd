#include "io/staged_output.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>
#include <vector>

#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace fs = std::filesystem;

StagedOutput::StagedOutput(const fs::path& target)
    : target_(target), folder_(target / (".saw_ndt-" + std::to_string(getpid()))) {
  std::error_code error;
  fs::create_directory(folder_, error);
  if (error) throw Error(target.string(), "", error.message());
}

StagedOutput::~StagedOutput() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

void StagedOutput::commit() const {
  std::vector<fs::path> folders, files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_)) {
    const fs::path name = entry.path().lexically_relative(folder_);
    std::error_code ignored;
    const fs::file_status there = fs::status(target_ / name, ignored);
    if (!entry.is_directory() && fs::is_directory(there)) throw Error((target_ / name).string(), "", "is a folder");
    if (entry.is_directory() && fs::exists(there) && !fs::is_directory(there)) {
      throw Error((target_ / name).string(), "", std::strerror(ENOTDIR));
    }
    (entry.is_directory() ? folders : files).push_back(name);
  }
  std::error_code error;
  for (const fs::path& name : folders) {
    fs::create_directory(target_ / name, error);
    if (error) throw Error((target_ / name).string(), "", error.message());
  }
  for (const fs::path& name : files) {
    fs::rename(folder_ / name, target_ / name, error);
    if (error) throw Error((target_ / name).string(), "", error.message());
  }
}

}  // namespace saw_ndt::internal
