#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// The files of a point cloud map in the order in which they are read.
struct CloudMapFiles {
  std::vector<std::filesystem::path> files;
  std::vector<std::string> beside;  ///< names of the clouds in the folder that its metadata do not name
};

/// A file itself; of a folder with Autoware's metadata the tiles that they name; of another one all .pcd and .ply
/// files. By name, numbers in it counting as such. Throws Error where there is none, or where a tile is missing.
SAW_NDT_EXPORT CloudMapFiles cloudMapFiles(const std::filesystem::path& path);

}  // namespace saw_ndt::internal
