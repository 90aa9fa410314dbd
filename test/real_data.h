#pragma once

#include <cstdlib>
#include <filesystem>

/// The folder of real recordings that tests may use: the environment's SAW_NDT_DATA, else `../shared/data` beside the
/// project. It may be absent: a test that needs it skips then, and says so.
inline std::filesystem::path realDataFolder() {
  const char* folder = std::getenv("SAW_NDT_DATA");
  return folder != nullptr ? std::filesystem::path(folder)
                           : std::filesystem::path(SAW_NDT_SOURCE_DIR) / ".." / "shared" / "data";
}
