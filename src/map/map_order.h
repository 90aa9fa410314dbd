#pragma once

#include <vector>

#include "saw_ndt/map/voxel_sums.h"

namespace saw_ndt::internal {

/// Sorts entries as inMapOrder() says.
void sortIntoMapOrder(std::vector<LabelledVoxelSums>& entries);

}  // namespace saw_ndt::internal
