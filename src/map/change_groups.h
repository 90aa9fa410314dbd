#pragma once

#include <vector>

#include "saw_ndt/map/map_diff.h"

namespace saw_ndt::internal {

/// Puts changed voxels of one kind that touch each other into groups, the largest first, and sets each voxel's group.
/// Voxels of groups smaller than `least_voxels` (in places, those of both maps together) are taken out and returned;
/// the order of the others stays.
struct GroupedChanges {
  std::vector<ChangedVoxel> changes, dropped;
  std::vector<ChangedGroup> groups;
};
GroupedChanges groupChanges(const std::vector<ChangedVoxel>& changes, int least_voxels, double resolution_m);

}  // namespace saw_ndt::internal
