#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "saw_ndt/map/voxel_sums.h"

namespace saw_ndt::internal {

/// How many of the lowest ten bits are set, by a table: programs are built for processors without such an instruction.
inline std::uint32_t countOfTenBits(std::uint32_t bits) {
  static constexpr std::array<std::uint8_t, 1024> kCounts = [] {
    std::array<std::uint8_t, 1024> counts{};
    for (std::size_t i = 1; i < counts.size(); ++i) counts[i] = static_cast<std::uint8_t>(counts[i / 2] + i % 2);
    return counts;
  }();
  return kCounts[bits & 0x3FFU];
}

/// Finds voxels, and all neighbours of a voxel, with one hash probe. Space is cut into bricks of 8 x 8 x 8 cells. A
/// brick has, for each of its rows along x, a bit a cell that says whether there is a voxel, and keeps the numbers of
/// its voxels one after the other. A border one cell wide repeats the cells of the bricks around it, so that every
/// neighbour of a cell is found in the same brick.
class VoxelIndex {
 public:
  static constexpr int kBrickBits = 3;
  static constexpr int kBrickSize = 1 << kBrickBits;
  static constexpr int kSpan = kBrickSize + 2;
  static constexpr int kRowsPerBrick = kSpan * kSpan;
  static constexpr std::int32_t kNone = -1;

  /// How many rows the neighbour at (any dx, dy, dz), each -1, 0 or 1, lies from a cell.
  static constexpr std::ptrdiff_t rowOffset(int dy, int dz) { return dy + kSpan * dz; }

  /// The cells of a brick that have the same y and z.
  class Row {
   public:
    /// Whether there is a voxel at place `x` of the row, 0 to kSpan - 1, as 1 or 0.
    std::uint32_t has(std::uint32_t x) const { return (bits_ >> x) & 1U; }
    /// Where the number of the voxel at place `x`, or else of the next one, stands among those of the brick.
    std::uint32_t rank(std::uint32_t x) const {
      return (bits_ >> kRankShift) + countOfTenBits(bits_ & ((1U << x) - 1U));
    }

   private:
    friend class VoxelIndex;
    static constexpr int kRankShift = 16;
    std::uint32_t bits_ = 0;  // a bit a cell, from kRankShift on the number of voxels in the rows before
  };

  /// Where a cell is in the index.
  struct Place {
    const Row* row = nullptr;               ///< to be read at rowOffset() too; null where the brick has no voxel
    const std::int32_t* numbers = nullptr;  ///< of the brick's voxels, by rank; one more can be read
    std::uint32_t x = 0;                    ///< in the row, 1 to kBrickSize

    explicit operator bool() const { return row != nullptr; }
    /// The number of the neighbour at (dx, dy, dz), each -1, 0 or 1, or kNone. The place is not null.
    std::int32_t number(int dx, int dy, int dz) const {
      const Row& at = row[rowOffset(dy, dz)];
      const std::uint32_t place = x + static_cast<std::uint32_t>(dx);
      return at.has(place) != 0 ? numbers[at.rank(place)] : kNone;
    }
  };

 private:
  struct Brick {
    std::uint32_t first = 0;  // of its numbers
    Row rows[kRowsPerBrick];
  };

 public:
  /// Remembers where the last look-up ended: points that follow each other often share a brick. One a thread.
  struct Cursor {
    Eigen::Vector3i at = Eigen::Vector3i::Zero();
    const Brick* brick = nullptr;
    bool valid = false;
  };

  VoxelIndex() = default;
  /// Numbers the voxels by their place in `voxels`, which holds each once.
  explicit VoxelIndex(const std::vector<VoxelCoordinate>& voxels);

  /// The number of a voxel, or kNone.
  std::int32_t find(const VoxelCoordinate& voxel) const;

  /// The place of `voxel`; null where neither it nor any of its neighbours can exist.
  Place place(const VoxelCoordinate& voxel, Cursor& cursor) const {
    const Eigen::Vector3i brick(voxel.x() >> kBrickBits, voxel.y() >> kBrickBits, voxel.z() >> kBrickBits);
    if (!cursor.valid || brick != cursor.at) {
      cursor.at = brick;
      cursor.brick = brickAt(brick);
      cursor.valid = true;
    }
    if (cursor.brick == nullptr) return {};
    constexpr int kMask = kBrickSize - 1;
    return {cursor.brick->rows + rowOffset((voxel.y() & kMask) + 1, (voxel.z() & kMask) + 1),
            numbers_.data() + cursor.brick->first, static_cast<std::uint32_t>(voxel.x() & kMask) + 1U};
  }

  /// The voxels that the index was made of, by number.
  std::vector<VoxelCoordinate> voxels() const;

 private:
  struct Slot {
    Eigen::Vector3i at;
    std::int32_t number = kNone;
  };

  const Brick* brickAt(const Eigen::Vector3i& at) const;
  std::size_t slotOf(const Eigen::Vector3i& at) const;
  std::uint32_t numberOfMadeBrick(const Eigen::Vector3i& at);

  std::vector<Slot> slots_;
  std::vector<Brick> bricks_;
  std::vector<std::int32_t> numbers_;
  std::size_t voxel_count_ = 0;
};

}  // namespace saw_ndt::internal
