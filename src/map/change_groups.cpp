#include "map/change_groups.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "map/map_tile.h"
#include "map/voxel_index.h"

namespace saw_ndt::internal {
namespace {

// Sets that are joined (union-find). The root of a set is its least member.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
  std::size_t rootOf(std::size_t member) {
    while (parent_[member] != member) {
      parent_[member] = parent_[parent_[member]];
      member = parent_[member];
    }
    return member;
  }
  void join(std::size_t a, std::size_t b) {
    const std::size_t root_a = rootOf(a), root_b = rootOf(b);
    parent_[std::max(root_a, root_b)] = std::min(root_a, root_b);
  }

 private:
  std::vector<std::size_t> parent_;
};

bool inOrderOfPlace(const VoxelCoordinate& a, const VoxelCoordinate& b) {
  return inMapOrder({a, StructuralLabel::NOISE, {}, 0}, {b, StructuralLabel::NOISE, {}, 0});
}

// The voxels of one kind, each once, and the root of each one's group.
struct Places {
  std::vector<VoxelCoordinate> voxels;
  VoxelIndex index;
  std::vector<std::size_t> roots;

  Places(const std::vector<ChangedVoxel>& changes, VoxelChange change) {
    for (const ChangedVoxel& changed : changes) {
      if (changed.change == change) voxels.push_back(changed.voxel);
    }
    std::sort(voxels.begin(), voxels.end(), inOrderOfPlace);
    voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
    index = VoxelIndex(voxels);
    Sets sets(voxels.size());
    VoxelIndex::Cursor cursor;
    for (std::size_t number = 0; number < voxels.size(); ++number) {
      const VoxelIndex::Place place = index.place(voxels[number], cursor);
      for (int i = 0; i < 27; ++i) {
        const std::int32_t other = place.number(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        if (other != VoxelIndex::kNone) sets.join(number, static_cast<std::size_t>(other));
      }
    }
    for (std::size_t number = 0; number < voxels.size(); ++number) roots.push_back(sets.rootOf(number));
  }
};

struct Group {
  ChangedGroup told;
  VoxelCoordinate least, greatest;
  std::size_t changes = 0;
};

// Appends the groups of one kind that are large enough; `group_of_root` tells their places, or none.
constexpr std::size_t kNone = static_cast<std::size_t>(-1);
std::vector<std::size_t> appendGroups(const Places& places, VoxelChange change, std::size_t least_voxels,
                                      std::vector<Group>& groups) {
  std::vector<std::size_t> sizes(places.voxels.size(), 0), group_of_root(places.voxels.size(), kNone);
  for (const std::size_t root : places.roots) ++sizes[root];
  for (std::size_t number = 0; number < places.voxels.size(); ++number) {
    const std::size_t root = places.roots[number];
    if (sizes[root] < least_voxels) continue;
    const VoxelCoordinate& voxel = places.voxels[number];
    if (group_of_root[root] == kNone) {
      group_of_root[root] = groups.size();
      Group& group = groups.emplace_back();
      group.told.change = change;
      group.told.voxels = sizes[root];
      group.least = group.greatest = voxel;
    }
    Group& group = groups[group_of_root[root]];
    group.least = group.least.cwiseMin(voxel);
    group.greatest = group.greatest.cwiseMax(voxel);
  }
  return group_of_root;
}

// Puts the largest group first; the places of the groups change.
void sortBySize(std::vector<Group>& groups, std::vector<ChangedVoxel>& changes) {
  std::vector<std::size_t> order(groups.size()), place(groups.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&groups](std::size_t a, std::size_t b) {
    if (groups[a].told.voxels != groups[b].told.voxels) return groups[a].told.voxels > groups[b].told.voxels;
    const auto key = [&groups](std::size_t i) {
      return std::make_tuple(groups[i].least.x(), groups[i].least.y(), groups[i].least.z(), groups[i].greatest.x(),
                             groups[i].greatest.y(), groups[i].greatest.z());
    };
    return key(a) < key(b);
  });
  std::vector<Group> sorted;
  for (std::size_t i = 0; i < order.size(); ++i) {
    place[order[i]] = i;
    sorted.push_back(groups[order[i]]);
  }
  groups = std::move(sorted);
  for (ChangedVoxel& changed : changes) changed.group = place[changed.group];
}

}  // namespace

GroupedChanges groupChanges(const std::vector<ChangedVoxel>& changes, int least_voxels, double resolution_m) {
  GroupedChanges grouped;
  std::vector<Group> groups;
  std::vector<std::size_t> group_of(changes.size(), kNone);
  for (const VoxelChange change : {VoxelChange::APPEARED, VoxelChange::VANISHED, VoxelChange::MOVED}) {
    const Places places(changes, change);
    const std::vector<std::size_t> group_of_root =
        appendGroups(places, change, static_cast<std::size_t>(least_voxels), groups);
    for (std::size_t i = 0; i < changes.size(); ++i) {
      if (changes[i].change != change) continue;
      const auto number = static_cast<std::size_t>(places.index.find(changes[i].voxel));
      group_of[i] = group_of_root[places.roots[number]];
    }
  }
  for (std::size_t i = 0; i < changes.size(); ++i) {
    if (group_of[i] == kNone) continue;
    grouped.changes.push_back(changes[i]);
    grouped.changes.back().group = group_of[i];
    groups[group_of[i]].told.displacement_m += changes[i].displacement_m;
    ++groups[group_of[i]].changes;
  }
  sortBySize(groups, grouped.changes);
  for (Group& group : groups) {
    group.told.displacement_m /= static_cast<double>(group.changes);
    group.told.least_m = group.least.cast<double>() * resolution_m;
    group.told.greatest_m = (group.greatest.cast<double>().array() + 1.0).matrix() * resolution_m;
    grouped.groups.push_back(group.told);
  }
  return grouped;
}

}  // namespace saw_ndt::internal
