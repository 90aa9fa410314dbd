#pragma once

#include <vector>

#include "saw_ndt/map/map_diff.h"

namespace saw_ndt::internal {

/// Changed voxels in groups.
struct GroupedChanges {
  std::vector<ChangedVoxel> changes;  ///< those of groups that are large enough, in the order given
  std::vector<ChangedGroup> groups;   ///< of them, the largest first
};

/// Puts changed voxels of one kind that touch each other into groups and sets each voxel's group. Groups of fewer than
/// `least_voxels` places, those of both maps together, are left out.
GroupedChanges groupChanges(const std::vector<ChangedVoxel>& changes, int least_voxels, double resolution_m);

}  // namespace saw_ndt::internal
