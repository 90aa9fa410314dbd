#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "map/direction_loops.h"
#include "saw_ndt/map/voxel_sums.h"

namespace saw_ndt::internal {

/// The voxels of a map that have points not labelled ground, and the means of these points, in cubes of 16 voxels, so
/// that those near a place are found without the rest.
class VoxelPatches {
 public:
  /// A cube: its voxels are `first` to `last`.
  struct Patch {
    Eigen::Vector3d centre_m;  ///< in the map frame
    std::size_t first = 0, last = 0;
  };

  /// @param entries  in map order
  VoxelPatches(const std::vector<LabelledVoxelSums>& entries, double resolution_m);

  const std::vector<Patch>& patches() const { return patches_; }
  /// From the centre of a patch to its farthest point (m).
  double radius() const { return radius_m_; }
  /// How many voxels there are.
  std::size_t size() const { return first_entry_.size(); }
  /// The place in `entries` of the first entry of a voxel, whatever its label.
  std::size_t firstEntry(std::size_t voxel) const { return first_entry_[voxel]; }
  /// The means from the centre of their patch (m), beginning with that of a voxel.
  PointArrays means(std::size_t voxel) const { return {&x_m_[voxel], &y_m_[voxel], &z_m_[voxel]}; }

 private:
  std::vector<Patch> patches_;
  double radius_m_;
  std::vector<std::size_t> first_entry_;
  std::vector<float> x_m_, y_m_, z_m_;
};

}  // namespace saw_ndt::internal
