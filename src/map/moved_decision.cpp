#include "map/moved_decision.h"

#include "map/voxel_index.h"

namespace saw_ndt::internal {
namespace {

constexpr std::uint64_t kMinSeenThrough = 3;
constexpr std::uint64_t kMostHitsForEachSeenThrough = 9;
constexpr int kLeastShareOfNeighbours = 4;  // one in so many

// Calls visit(number) for each neighbour that there is.
template <typename Visit>
void forEachNeighbour(const VoxelIndex::Place& place, const Visit& visit) {
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (dx == 0 && dy == 0 && dz == 0) continue;
        const std::int32_t number = place.number(dx, dy, dz);
        if (number != VoxelIndex::kNone) visit(static_cast<std::size_t>(number));
      }
    }
  }
}

}  // namespace

std::vector<std::uint8_t> voxelsThatMoved(const std::vector<VoxelSightings>& voxels, double max_hit_share) {
  std::vector<std::uint8_t> moved(voxels.size(), 0);
  std::vector<std::size_t> found;  // whose neighbours are still to be looked at
  std::vector<VoxelCoordinate> coordinates;
  coordinates.reserve(voxels.size());
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const VoxelSightings& voxel = voxels[i];
    coordinates.push_back(voxel.voxel);
    const auto seen = static_cast<double>(voxel.hits + voxel.seen_through);
    if (voxel.seen_through < kMinSeenThrough || static_cast<double>(voxel.hits) >= max_hit_share * seen) continue;
    moved[i] = 1;
    found.push_back(i);
  }
  if (found.empty()) return moved;

  const VoxelIndex index(coordinates);
  VoxelIndex::Cursor cursor;
  std::vector<std::size_t> doubtful;
  // A voxel that is found never makes another one stay: the end is the same whatever the order.
  for (std::size_t next = 0; next < found.size(); ++next) {
    doubtful.clear();
    forEachNeighbour(index.place(coordinates[found[next]], cursor), [&](std::size_t i) {
      const VoxelSightings& voxel = voxels[i];
      if (moved[i] == 0 && voxel.hits <= kMostHitsForEachSeenThrough * voxel.seen_through) doubtful.push_back(i);
    });
    for (const std::size_t i : doubtful) {
      int neighbours = 0, moved_neighbours = 0;
      forEachNeighbour(index.place(coordinates[i], cursor), [&](std::size_t neighbour) {
        ++neighbours;
        moved_neighbours += moved[neighbour];
      });
      if (kLeastShareOfNeighbours * moved_neighbours < neighbours) continue;
      moved[i] = 1;
      found.push_back(i);
    }
  }
  return moved;
}

}  // namespace saw_ndt::internal
