#include "map/voxel_patches.h"

#include <algorithm>
#include <cmath>

namespace saw_ndt::internal {
namespace {

constexpr int kPatchBits = 4;

Eigen::Vector3i patchOf(const VoxelCoordinate& voxel) {
  return {voxel.x() >> kPatchBits, voxel.y() >> kPatchBits, voxel.z() >> kPatchBits};
}

// The mean of the points that are not labelled ground in the voxel that begins at an entry, in the map frame (m).
Eigen::Vector3d meanOf(const std::vector<LabelledVoxelSums>& entries, std::size_t first, double resolution_m) {
  VoxelSums sums;
  for (std::size_t i = first; i < entries.size() && entries[i].voxel == entries[first].voxel; ++i) {
    if (entries[i].label != StructuralLabel::GROUND) sums += entries[i].sums;
  }
  Eigen::Vector3d mean = entries[first].voxel.cast<double>().array() + 0.5;
  for (int axis = 0; axis < 3; ++axis) {
    mean[axis] += static_cast<double>(sums.sum[static_cast<std::size_t>(axis)]) /
                  (static_cast<double>(sums.count) * kStepsPerVoxel);
  }
  return mean * resolution_m;
}

}  // namespace

VoxelPatches::VoxelPatches(const std::vector<LabelledVoxelSums>& entries, double resolution_m) {
  for (std::size_t i = 0; i < entries.size();) {
    bool belongs = false;
    const std::size_t first = i;
    for (; i < entries.size() && entries[i].voxel == entries[first].voxel; ++i) {
      belongs = belongs || entries[i].label != StructuralLabel::GROUND;
    }
    if (belongs) first_entry_.push_back(first);
  }
  // Map order keeps the voxels of a patch in rows that are apart.
  std::sort(first_entry_.begin(), first_entry_.end(), [&](std::size_t a, std::size_t b) {
    const Eigen::Vector3i of_a = patchOf(entries[a].voxel), of_b = patchOf(entries[b].voxel);
    for (const int axis : {2, 1, 0}) {
      if (of_a[axis] != of_b[axis]) return of_a[axis] < of_b[axis];
    }
    return a < b;
  });

  const double patch_size_m = resolution_m * (1 << kPatchBits);
  radius_m_ = 0.5 * std::sqrt(3.0) * patch_size_m;
  for (std::vector<float>* means : {&x_m_, &y_m_, &z_m_}) means->reserve(size());
  for (std::size_t i = 0; i < size(); ++i) {
    const Eigen::Vector3i patch = patchOf(entries[first_entry_[i]].voxel);
    if (i == 0 || patch != patchOf(entries[first_entry_[i - 1]].voxel)) {
      patches_.push_back({(patch.cast<double>().array() + 0.5).matrix() * patch_size_m, i, i});
    }
    patches_.back().last = i + 1;
    const Eigen::Vector3f mean =
        (meanOf(entries, first_entry_[i], resolution_m) - patches_.back().centre_m).cast<float>();
    x_m_.push_back(mean.x());
    y_m_.push_back(mean.y());
    z_m_.push_back(mean.z());
  }
}

}  // namespace saw_ndt::internal
