#include "saw_ndt/map/voxel_index.h"

#include "saw_ndt/map/voxel_sums_table.h"

namespace saw_ndt {
namespace {

// The bricks, relative to a voxel's own, whose border repeats the cell at `local` along one axis.
struct BrickRange {
  int first, last;
};
BrickRange bricksThatHold(int local) { return {local == 0 ? -1 : 0, local == VoxelIndex::kBrickSize - 1 ? 1 : 0}; }

}  // namespace

VoxelIndex::VoxelIndex(const std::vector<VoxelCoordinate>& voxels) : slots_(64) {
  for (std::size_t number = 0; number < voxels.size(); ++number) {
    const VoxelCoordinate& voxel = voxels[number];
    const Eigen::Vector3i brick(voxel.x() >> kBrickBits, voxel.y() >> kBrickBits, voxel.z() >> kBrickBits);
    const Eigen::Vector3i local = voxel - brick * kBrickSize;
    const BrickRange xs = bricksThatHold(local.x()), ys = bricksThatHold(local.y()), zs = bricksThatHold(local.z());
    for (int dz = zs.first; dz <= zs.last; ++dz) {
      for (int dy = ys.first; dy <= ys.last; ++dy) {
        for (int dx = xs.first; dx <= xs.last; ++dx) {
          const Eigen::Vector3i at = local - kBrickSize * Eigen::Vector3i(dx, dy, dz);
          std::int32_t* cells = makeBrick(brick + Eigen::Vector3i(dx, dy, dz));
          cells[neighbourOffset(at.x() + 1, at.y() + 1, at.z() + 1)] = static_cast<std::int32_t>(number);
        }
      }
    }
  }
}

std::int32_t VoxelIndex::find(const VoxelCoordinate& voxel) const {
  Cursor cursor;
  const std::int32_t* found = cell(voxel, cursor);
  return found == nullptr ? kNone : *found;
}

std::size_t VoxelIndex::slotOf(const Eigen::Vector3i& brick) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = hashCoordinate(brick) & mask;
  while (slots_[slot].number != kNone && slots_[slot].brick != brick) slot = (slot + 1) & mask;
  return slot;
}

const std::int32_t* VoxelIndex::cellsOf(const Eigen::Vector3i& brick) const {
  if (slots_.empty()) return nullptr;
  const std::int32_t number = slots_[slotOf(brick)].number;
  return number == kNone ? nullptr : cells_.data() + static_cast<std::size_t>(number) * kCellsPerBrick;
}

std::int32_t* VoxelIndex::makeBrick(const Eigen::Vector3i& brick) {
  std::size_t slot = slotOf(brick);
  if (slots_[slot].number == kNone) {
    if (2 * (brick_count_ + 1) > slots_.size()) {
      std::vector<Slot> old(2 * slots_.size());
      old.swap(slots_);
      for (const Slot& entry : old) {
        if (entry.number != kNone) slots_[slotOf(entry.brick)] = entry;
      }
      slot = slotOf(brick);
    }
    slots_[slot] = {brick, static_cast<std::int32_t>(brick_count_)};
    ++brick_count_;
    cells_.resize(brick_count_ * kCellsPerBrick, kNone);
  }
  return cells_.data() + static_cast<std::size_t>(slots_[slot].number) * kCellsPerBrick;
}

}  // namespace saw_ndt
