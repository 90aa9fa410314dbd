#pragma once

#include <string>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt {

/// The map of the scans of several map files, as WeightedMapBuilder::merge() makes it; their order does not matter. The
/// files are read one after the other.
/// @param paths  one or more
/// @throws Error where a file cannot be read, is given twice, under whatever name, or does not merge with the first
/// one: it names both and says what differs. std::invalid_argument where there is no path
SAW_NDT_EXPORT WeightedVoxelMap mergeMapFiles(const std::vector<std::string>& paths);

}  // namespace saw_ndt
