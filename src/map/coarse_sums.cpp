#include "map/coarse_sums.h"

#include <algorithm>
#include <array>

#include "common/floor_division.h"
#include "map/map_order.h"

namespace saw_ndt::internal {
namespace {

// What is known for sure of a coarse voxel: one of its fine ones was met by so many scans.
void countScans(const LabelledVoxelSums& from, LabelledVoxelSums& into) {
  into.scan_count = std::max(into.scan_count, from.scan_count);
}

}  // namespace

void CoarseSums::add(const LabelledVoxelSums* first, const LabelledVoxelSums* last) {
  // Fine voxels that follow each other often share their coarse one: its places in the table are kept, by label.
  std::array<std::size_t, kStructuralLabelCount> places{};
  std::array<bool, kStructuralLabelCount> known{};
  VoxelCoordinate parent = VoxelCoordinate::Zero();
  for (; first != last; ++first) {
    VoxelCoordinate voxel;
    std::array<std::int64_t, 3> shift;  // from the fine voxel's centre to the coarse one's
    for (int axis = 0; axis < 3; ++axis) {
      voxel[axis] = floorDivided(first->voxel[axis], factor_);
      const std::int64_t place =
          static_cast<std::int64_t>(first->voxel[axis]) - static_cast<std::int64_t>(voxel[axis]) * factor_;
      shift[static_cast<std::size_t>(axis)] = (2 * place + 1 - factor_) * (kStepsPerVoxel / 2);
    }
    if (voxel != parent) {
      parent = voxel;
      known.fill(false);
    }
    const auto label = static_cast<std::size_t>(first->label);
    if (!known[label]) {
      places[label] = table_.placeOf(parent, first->label);
      known[label] = true;
    }
    LabelledVoxelSums& entry = table_.entry(places[label]);
    entry.sums += first->sums.shifted(shift);
    countScans(*first, entry);
  }
}

void CoarseSums::add(const CoarseSums& other) {
  table_.add(other.table_,
             [](const LabelledVoxelSums& from, LabelledVoxelSums& into, std::size_t) { countScans(from, into); });
}

std::vector<LabelledVoxelSums> CoarseSums::takeInMapOrder() {
  std::vector<LabelledVoxelSums> entries = table_.takeEntries();
  sortIntoMapOrder(entries);
  return entries;
}

}  // namespace saw_ndt::internal
