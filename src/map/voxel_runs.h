#pragma once

#include <cstddef>
#include <cstdint>

namespace saw_ndt::internal {

/// How points become voxels.
struct PointPlacement {
  double T_map_points[3][4];  ///< rotation and translation (m)
  bool in_map_frame;          ///< whether that is the identity
  double inverse_resolution;  ///< 1/m
};

/// The `label` of points that are no return, not finite or too far out for a voxel.
constexpr std::int32_t kNoVoxel = -1;

/// Sums of points that follow each other and share voxel and label.
struct VoxelRun {
  std::int64_t product[6];    ///< square steps: xx xy xz yy yz zz
  std::int32_t sum_count[4];  ///< steps x y z, number of points
};

/// A block of points on its way to runs.
struct PointBlock {
  static constexpr std::size_t kMostPoints = 512;
  static constexpr std::size_t kRoom = kMostPoints + 16;  // vectors may reach beyond the last point

  const float* xyz;    ///< x of the first point, y and z behind it (m)
  std::size_t stride;  ///< floats from one point's x to the next one's, 3 or more
  std::size_t size;    ///< 1 to kMostPoints

  // By point:
  alignas(64) std::int32_t label[kRoom];  ///< read, and made kNoVoxel where a point has none
  alignas(64) std::int32_t voxel[3][kRoom];
  alignas(64) std::int32_t steps[4 * kRoom];  ///< x y z 1
  alignas(64) std::int32_t same[kRoom];       ///< -1 where voxel and label are those of the point before, otherwise 0

  /// Run after run.
  alignas(64) VoxelRun runs[kMostPoints];
};

/// Finds the runs of a block of which points and labels are set, for the instruction set in use. Every one of them
/// gives what quantize() and VoxelSums::add() give point by point, bit for bit.
/// @return the number of runs
std::size_t findVoxelRuns(const PointPlacement& placement, PointBlock& block);

}  // namespace saw_ndt::internal
