#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "map/level_plan.h"
#include "saw_ndt/common/export.h"
#include "saw_ndt/map/voxel_statistics.h"

namespace saw_ndt::internal {

/// Makes the distributions of the voxels of a level from entries, which hold the entries of a voxel one after the
/// other, and calls visit() with a batch of them at a time, in their order. Entries whose label has confidence 0 take
/// no part. What comes of a voxel does not depend on the others.
/// @param metres_per_step  size of the step in which the sums count
void forEachStatistics(const LabelledVoxelSums* first, const LabelledVoxelSums* last, const VoxelWeighting& weighting,
                       const LevelPlan& level, double metres_per_step,
                       const std::function<void(const std::vector<VoxelStatistics>&)>& visit);

/// How many voxels of entries have a distribution, by the default weighting.
SAW_NDT_EXPORT std::uint64_t voxelCountOf(const LabelledVoxelSums* first, const LabelledVoxelSums* last,
                                          double resolution_m);

/// How many points entries have.
std::uint64_t pointCountOf(const LabelledVoxelSums* first, const LabelledVoxelSums* last);

/// Cuts entries into parts of whole voxels and calls process(part, first, last) for each, by several threads. `prepare`
/// is called first with the number of parts.
/// @param threads  0: all cores
void forEachPartOfVoxels(const std::vector<LabelledVoxelSums>& entries, int threads,
                         const std::function<void(std::size_t part_count)>& prepare,
                         const std::function<void(std::size_t part, const LabelledVoxelSums* first,
                                                  const LabelledVoxelSums* last)>& process);

}  // namespace saw_ndt::internal
