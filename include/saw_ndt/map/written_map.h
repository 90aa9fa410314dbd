#pragma once

#include <cstdint>

#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt {

/// What a map file holds that was written a tile at a time.
struct WrittenMap {
  MapOrigin origin;
  std::uint64_t voxel_count = 0;  ///< that have a distribution, by the default weighting
  std::uint64_t entry_count = 0;  ///< sums: one a voxel and label that occurs in it
  std::uint64_t tile_count = 0;
  std::uint64_t file_bytes = 0;
};

}  // namespace saw_ndt
