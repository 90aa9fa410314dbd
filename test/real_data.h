#pragma once

#include <cstdlib>
#include <filesystem>

namespace saw_ndt {

/// The folder of the real scans, which are no part of the project: the environment variable SAW_NDT_DATA, or else
/// `../shared/data` beside the project. Empty where it is not there: the test then skips itself and says so.
inline std::filesystem::path realDataFolder() {
  const char* stated = std::getenv("SAW_NDT_DATA");
  const std::filesystem::path folder = stated != nullptr
                                           ? std::filesystem::path(stated)
                                           : std::filesystem::path(SAW_NDT_SOURCE_DIR) / ".." / "shared" / "data";
  return std::filesystem::is_directory(folder / "kitti" / "sequences") ? folder : std::filesystem::path();
}

}  // namespace saw_ndt
