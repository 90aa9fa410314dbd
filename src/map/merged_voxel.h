#pragma once

#include <cstddef>
#include <vector>

#include "map/level_plan.h"
#include "saw_ndt/map/voxel_statistics.h"

namespace saw_ndt::internal {

/// The points of one voxel, its labels put together.
struct MergedVoxel {
  VoxelCoordinate voxel = VoxelCoordinate::Zero();
  VoxelSums sums;
  double mean_confidence = 0.0;  ///< of the structural confidences of those points
  double ground_share = 0.0;     ///< of the points
  std::uint32_t scan_count = 0;  ///< of the label that most scans met; 0: not known
};

/// Appends what voxelStatistics() says of each voxel, in their order, without those of which it says nothing and those
/// that the level leaves out.
/// @param metres_per_step  size of the step in which the sums count
void appendVoxelStatistics(const MergedVoxel* voxels, std::size_t count, const VoxelWeighting& weighting,
                           const LevelPlan& level, double metres_per_step, std::vector<VoxelStatistics>& statistics);

}  // namespace saw_ndt::internal
