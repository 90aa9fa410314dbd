#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "saw_ndt/registration/source_points.h"

namespace saw_ndt {

/// Thins a source: one centroid for every voxel and label, so that no centroid mixes labels. Keeps its scratch memory
/// between calls.
class SourceVoxelFilter {
 public:
  /// @param voxel_size_m  edge of a voxel; 0 keeps every point as it is
  /// @throws std::invalid_argument where it is negative or not finite
  explicit SourceVoxelFilter(double voxel_size_m);

  /// Starts a new source; with labels or without.
  void start(bool labelled);
  /// Adds a point (m, frame of the source). What is not finite, or 2e9 voxels or more from the origin along an axis, is
  /// passed over.
  void add(const Eigen::Vector3f& point, StructuralLabel label);
  /// The centroids in the order in which their voxels were first met. Valid until the next start().
  const SourcePoints& finish();

 private:
  struct Cell {
    Eigen::Vector3i voxel;
    StructuralLabel label = StructuralLabel::NonGround;
    std::uint32_t count = 0;
    Eigen::Vector3f offset_sum;  // from the voxel's lower corner
  };

  std::size_t find(const Eigen::Vector3i& voxel, StructuralLabel label) const;
  void grow();

  double voxel_size_m_;
  float inverse_size_ = 0.0f;
  std::vector<std::uint32_t> slots_;
  std::vector<Cell> cells_;
  SourcePoints points_;
};

}  // namespace saw_ndt
