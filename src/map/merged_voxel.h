#pragma once

#include <cstddef>
#include <vector>

#include "saw_ndt/map/voxel_statistics.h"

namespace saw_ndt::internal {

/// The points of one voxel, its labels put together.
struct MergedVoxel {
  VoxelCoordinate voxel = VoxelCoordinate::Zero();
  VoxelSums sums;
  double mean_confidence = 0.0;  ///< of the structural confidences of those points
};

/// Appends what voxelStatistics() says of each voxel, in their order, without those of which it says nothing.
void appendVoxelStatistics(const MergedVoxel* voxels, std::size_t count, const VoxelWeighting& weighting,
                           double metres_per_step, std::vector<VoxelStatistics>& statistics);

}  // namespace saw_ndt::internal
