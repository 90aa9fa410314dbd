#pragma once

#include <cstdint>
#include <vector>

#include "saw_ndt/map/voxel_sums.h"

namespace saw_ndt {

/// Finds voxels, and all neighbours of a voxel, with one hash probe. Space is cut into bricks of 8 x 8 x 8 cells; a
/// brick holds the numbers of its voxels densely, with a border one cell wide that repeats the cells of the bricks
/// around it, so that every neighbour of a cell lies at a fixed distance from it in memory.
class VoxelIndex {
 public:
  static constexpr int kBrickBits = 3;
  static constexpr int kBrickSize = 1 << kBrickBits;
  static constexpr int kSpan = kBrickSize + 2;
  static constexpr int kCellsPerBrick = kSpan * kSpan * kSpan;
  static constexpr std::int32_t kNone = -1;

  /// How far the neighbour at (dx, dy, dz), each -1, 0 or 1, lies from a cell in memory.
  static constexpr std::ptrdiff_t neighbourOffset(int dx, int dy, int dz) { return dx + kSpan * (dy + kSpan * dz); }

  /// Remembers where the last look-up ended: points that follow each other often share a brick. One a thread.
  struct Cursor {
    Eigen::Vector3i brick = Eigen::Vector3i::Zero();
    const std::int32_t* cells = nullptr;
    bool valid = false;
  };

  VoxelIndex() = default;
  /// Numbers the voxels by their place in `voxels`, which holds each once.
  explicit VoxelIndex(const std::vector<VoxelCoordinate>& voxels);

  /// The number of a voxel, or kNone.
  std::int32_t find(const VoxelCoordinate& voxel) const;

  /// The cell of `voxel` in its brick, to be read at neighbourOffset() too; null where neither it nor any of its
  /// neighbours can exist.
  const std::int32_t* cell(const VoxelCoordinate& voxel, Cursor& cursor) const {
    const Eigen::Vector3i brick(voxel.x() >> kBrickBits, voxel.y() >> kBrickBits, voxel.z() >> kBrickBits);
    if (!cursor.valid || brick != cursor.brick) {
      cursor.brick = brick;
      cursor.cells = cellsOf(brick);
      cursor.valid = true;
    }
    if (cursor.cells == nullptr) return nullptr;
    constexpr int kMask = kBrickSize - 1;
    return cursor.cells + neighbourOffset((voxel.x() & kMask) + 1, (voxel.y() & kMask) + 1, (voxel.z() & kMask) + 1);
  }

 private:
  struct Slot {
    Eigen::Vector3i brick;
    std::int32_t number = kNone;
  };

  const std::int32_t* cellsOf(const Eigen::Vector3i& brick) const;
  std::size_t slotOf(const Eigen::Vector3i& brick) const;
  void makeBrick(const Eigen::Vector3i& brick);

  std::vector<Slot> slots_;
  std::vector<std::int32_t> cells_;
  std::size_t brick_count_ = 0;
};

}  // namespace saw_ndt
