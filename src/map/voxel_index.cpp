#include "map/voxel_index.h"

#include "map/voxel_sums_table.h"

namespace saw_ndt {
namespace {

// The bricks, relative to a voxel's own, whose border repeats the cell at `local` along one axis.
struct BrickRange {
  int first, last;
};
BrickRange bricksThatHold(int local) { return {local == 0 ? -1 : 0, local == VoxelIndex::kBrickSize - 1 ? 1 : 0}; }

// Calls visit(brick, place of the voxel's cell in it) for every brick that holds a voxel, in its border or not.
template <typename Visit>
void forEachBrickWith(const VoxelCoordinate& voxel, const Visit& visit) {
  const Eigen::Vector3i brick(voxel.x() >> VoxelIndex::kBrickBits, voxel.y() >> VoxelIndex::kBrickBits,
                              voxel.z() >> VoxelIndex::kBrickBits);
  const Eigen::Vector3i local = voxel - brick * VoxelIndex::kBrickSize;
  const BrickRange xs = bricksThatHold(local.x()), ys = bricksThatHold(local.y()), zs = bricksThatHold(local.z());
  for (int dz = zs.first; dz <= zs.last; ++dz) {
    for (int dy = ys.first; dy <= ys.last; ++dy) {
      for (int dx = xs.first; dx <= xs.last; ++dx) {
        const Eigen::Vector3i at = local - VoxelIndex::kBrickSize * Eigen::Vector3i(dx, dy, dz);
        visit(brick + Eigen::Vector3i(dx, dy, dz), VoxelIndex::neighbourOffset(at.x() + 1, at.y() + 1, at.z() + 1));
      }
    }
  }
}

}  // namespace

VoxelIndex::VoxelIndex(const std::vector<VoxelCoordinate>& voxels) : slots_(64) {
  // The bricks are counted first, so that their memory is taken once and never moved. Voxels that follow each other
  // often touch the same one.
  Eigen::Vector3i latest = Eigen::Vector3i::Zero();
  bool any = false;
  for (const VoxelCoordinate& voxel : voxels) {
    forEachBrickWith(voxel, [&](const Eigen::Vector3i& brick, std::ptrdiff_t) {
      if (any && brick == latest) return;
      makeBrick(brick);
      latest = brick;
      any = true;
    });
  }
  cells_.assign(brick_count_ * kCellsPerBrick, kNone);
  any = false;
  std::int32_t* cells = nullptr;
  for (std::size_t number = 0; number < voxels.size(); ++number) {
    forEachBrickWith(voxels[number], [&](const Eigen::Vector3i& brick, std::ptrdiff_t cell) {
      if (!any || brick != latest) {
        cells = cells_.data() + static_cast<std::size_t>(slots_[slotOf(brick)].number) * kCellsPerBrick;
        latest = brick;
        any = true;
      }
      cells[cell] = static_cast<std::int32_t>(number);
    });
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

void VoxelIndex::makeBrick(const Eigen::Vector3i& brick) {
  std::size_t slot = slotOf(brick);
  if (slots_[slot].number != kNone) return;
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
}

}  // namespace saw_ndt
