#pragma once

#include <cstdint>
#include <vector>

#include "saw_ndt/map/voxel_sums.h"

namespace saw_ndt::internal {

/// How the scans saw a voxel.
struct VoxelSightings {
  VoxelCoordinate voxel;
  std::uint64_t hits = 0;  ///< scans that have points in it, at most
  std::uint64_t seen_through = 0;
};

/// Tells which voxels hold what moved. Those that less than `max_hit_share` of the scans hit which saw them do, and
/// three scans at least saw through them. So do those that at least a tenth of the scans saw through, of whose
/// neighbours a quarter or more do. The answer does not depend on the order of voxels.
/// @param voxels  each once
/// @return one a voxel, 1 or 0
std::vector<std::uint8_t> voxelsThatMoved(const std::vector<VoxelSightings>& voxels, double max_hit_share);

}  // namespace saw_ndt::internal
