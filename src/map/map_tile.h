#pragma once

#include "saw_ndt/map/voxel_sums.h"

namespace saw_ndt::internal {

/// Maps are laid out in cubic tiles, so that a region can be read without the rest.
constexpr int kTileBits = 6;
/// Edge of a tile in voxels.
constexpr int kTileSize = 1 << kTileBits;

/// The tile that holds a voxel.
inline Eigen::Vector3i tileOf(const VoxelCoordinate& voxel) {
  return {voxel.x() >> kTileBits, voxel.y() >> kTileBits, voxel.z() >> kTileBits};
}

/// Strict order of map entries: by tile, then voxel, each by z, y and x, then label. The file's order.
inline bool inMapOrder(const LabelledVoxelSums& a, const LabelledVoxelSums& b) {
  const Eigen::Vector3i tile_a = tileOf(a.voxel), tile_b = tileOf(b.voxel);
  for (const int axis : {2, 1, 0}) {
    if (tile_a[axis] != tile_b[axis]) return tile_a[axis] < tile_b[axis];
  }
  for (const int axis : {2, 1, 0}) {
    if (a.voxel[axis] != b.voxel[axis]) return a.voxel[axis] < b.voxel[axis];
  }
  return a.label < b.label;
}

}  // namespace saw_ndt::internal
