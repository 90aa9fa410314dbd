#include "map/voxel_index.h"

#include "map/voxel_sums_table.h"

namespace saw_ndt::internal {
namespace {

// The bricks, relative to a voxel's own, whose border repeats the cell at `local` along one axis.
struct BrickRange {
  int first, last;
};
BrickRange bricksThatHold(int local) { return {local == 0 ? -1 : 0, local == VoxelIndex::kBrickSize - 1 ? 1 : 0}; }

// Calls visit(brick, row of the voxel in it, place of the voxel in the row) for every brick that holds a voxel, in its
// border or not.
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
        visit(brick + Eigen::Vector3i(dx, dy, dz), VoxelIndex::rowOffset(at.y() + 1, at.z() + 1),
              static_cast<std::uint32_t>(at.x()) + 1U);
      }
    }
  }
}

// The numbers of the bricks around one, as far as they are known.
class BricksAround {
 public:
  static constexpr std::uint32_t kUnknown = 0xFFFFFFFFU;

  void moveTo(const VoxelCoordinate& voxel) {
    const Eigen::Vector3i middle(voxel.x() >> VoxelIndex::kBrickBits, voxel.y() >> VoxelIndex::kBrickBits,
                                 voxel.z() >> VoxelIndex::kBrickBits);
    if (known_ && middle == middle_) return;
    known_ = true;
    middle_ = middle;
    numbers_.fill(kUnknown);
  }
  /// Of the middle one, or one beside it.
  std::uint32_t& number(const Eigen::Vector3i& at) {
    const Eigen::Vector3i from = at - middle_;
    return numbers_[static_cast<std::size_t>((from.z() * 3 + from.y()) * 3 + from.x() + 13)];
  }

 private:
  bool known_ = false;
  Eigen::Vector3i middle_ = Eigen::Vector3i::Zero();
  std::array<std::uint32_t, 27> numbers_{};
};

}  // namespace

VoxelIndex::VoxelIndex(const std::vector<VoxelCoordinate>& voxels) : slots_(64), voxel_count_(voxels.size()) {
  // Voxels that follow each other are often of the same brick: the numbers of those around it are kept. Which ones a
  // voxel touches is kept for the second pass.
  std::vector<std::uint32_t> touched;
  touched.reserve(2 * voxels.size());
  BricksAround around;
  for (const VoxelCoordinate& voxel : voxels) {
    around.moveTo(voxel);
    forEachBrickWith(voxel, [&](const Eigen::Vector3i& at, std::ptrdiff_t row, std::uint32_t x) {
      std::uint32_t& number = around.number(at);
      if (number == BricksAround::kUnknown) number = numberOfMadeBrick(at);
      bricks_[number].rows[row].bits_ |= 1U << x;
      touched.push_back(number);
    });
  }
  std::uint32_t total = 0;
  for (Brick& brick : bricks_) {
    brick.first = total;
    std::uint32_t rank = 0;
    for (Row& row : brick.rows) {
      const std::uint32_t count = countOfTenBits(row.bits_);
      row.bits_ |= rank << Row::kRankShift;
      rank += count;
    }
    total += rank;
  }
  numbers_.assign(total + 1U, 0);
  auto next = touched.begin();
  for (std::size_t number = 0; number < voxels.size(); ++number) {
    forEachBrickWith(voxels[number], [&](const Eigen::Vector3i&, std::ptrdiff_t row, std::uint32_t x) {
      const Brick& brick = bricks_[*next++];
      numbers_[brick.first + brick.rows[row].rank(x)] = static_cast<std::int32_t>(number);
    });
  }
}

std::int32_t VoxelIndex::find(const VoxelCoordinate& voxel) const {
  Cursor cursor;
  const Place found = place(voxel, cursor);
  return found ? found.number(0, 0, 0) : kNone;
}

std::vector<VoxelCoordinate> VoxelIndex::voxels() const {
  std::vector<VoxelCoordinate> voxels(voxel_count_);
  for (const Slot& slot : slots_) {
    if (slot.number == kNone) continue;
    const Brick& brick = bricks_[static_cast<std::size_t>(slot.number)];
    for (int z = 0; z < kBrickSize; ++z) {
      for (int y = 0; y < kBrickSize; ++y) {
        const Row& row = brick.rows[rowOffset(y + 1, z + 1)];
        for (int x = 0; x < kBrickSize; ++x) {
          const auto place = static_cast<std::uint32_t>(x) + 1U;
          if (row.has(place) == 0) continue;
          voxels[static_cast<std::size_t>(numbers_[brick.first + row.rank(place)])] =
              slot.at * kBrickSize + Eigen::Vector3i(x, y, z);
        }
      }
    }
  }
  return voxels;
}

std::size_t VoxelIndex::slotOf(const Eigen::Vector3i& at) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = hashCoordinate(at) & mask;
  while (slots_[slot].number != kNone && slots_[slot].at != at) slot = (slot + 1) & mask;
  return slot;
}

const VoxelIndex::Brick* VoxelIndex::brickAt(const Eigen::Vector3i& at) const {
  if (slots_.empty()) return nullptr;
  const std::int32_t number = slots_[slotOf(at)].number;
  return number == kNone ? nullptr : bricks_.data() + number;
}

std::uint32_t VoxelIndex::numberOfMadeBrick(const Eigen::Vector3i& at) {
  std::size_t slot = slotOf(at);
  if (slots_[slot].number != kNone) return static_cast<std::uint32_t>(slots_[slot].number);
  if (2 * (bricks_.size() + 1) > slots_.size()) {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (const Slot& entry : old) {
      if (entry.number != kNone) slots_[slotOf(entry.at)] = entry;
    }
    slot = slotOf(at);
  }
  const auto number = static_cast<std::uint32_t>(bricks_.size());
  slots_[slot] = {at, static_cast<std::int32_t>(number)};
  bricks_.emplace_back();
  return number;
}

}  // namespace saw_ndt::internal
