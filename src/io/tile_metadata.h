#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// A tile of a point cloud map.
struct MapTileEntry {
  std::string name;                  ///< of a PCD file, without a folder
  std::array<double, 2> corner_m{};  ///< least x and y of the tile
};

/// What Autoware's pointcloud_map_metadata.yaml states.
struct TileMetadata {
  double x_resolution_m = 0.0, y_resolution_m = 0.0;  ///< edges of a tile
  std::vector<MapTileEntry> tiles;                    ///< in the order of the file
};

/// Throws Error that names the line of what is not as above, and where saw_ndt was built without yaml-cpp.
SAW_NDT_EXPORT TileMetadata readTileMetadata(const std::filesystem::path& path);

}  // namespace saw_ndt::internal
