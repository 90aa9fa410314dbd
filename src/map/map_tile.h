#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

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

/// What the directory of a map file tells of a tile.
struct MapTileRecord {
  Eigen::Vector3i coordinate = Eigen::Vector3i::Zero();  ///< see tileOf()
  std::uint32_t checksum = 0;                            ///< CRC-32 of the entries' bytes
  std::uint64_t entry_count = 0;
  std::uint64_t offset = 0;  ///< of the entries in the file
};

/// Strict order of tiles: by z, y and x. The file's order.
inline bool tileInMapOrder(const Eigen::Vector3i& a, const Eigen::Vector3i& b) {
  for (const int axis : {2, 1, 0}) {
    if (a[axis] != b[axis]) return a[axis] < b[axis];
  }
  return false;
}

/// Strict order of map entries: by tile, then voxel, each by z, y and x, then label. The file's order.
inline bool inMapOrder(const LabelledVoxelSums& a, const LabelledVoxelSums& b) {
  const Eigen::Vector3i tile_a = tileOf(a.voxel), tile_b = tileOf(b.voxel);
  if (tile_a != tile_b) return tileInMapOrder(tile_a, tile_b);
  for (const int axis : {2, 1, 0}) {
    if (a.voxel[axis] != b.voxel[axis]) return a.voxel[axis] < b.voxel[axis];
  }
  return a.label < b.label;
}

/// Where each tile of entries in map order ends: the place of the first entry of the next one.
inline std::vector<std::size_t> endsOfTiles(const std::vector<LabelledVoxelSums>& entries) {
  std::vector<std::size_t> ends;
  for (std::size_t i = 1; i <= entries.size(); ++i) {
    if (i == entries.size() || tileOf(entries[i].voxel) != tileOf(entries[i - 1].voxel)) ends.push_back(i);
  }
  return ends;
}

}  // namespace saw_ndt::internal
