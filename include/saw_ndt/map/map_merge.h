#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/map/weighted_voxel_map.h"
#include "saw_ndt/map/written_map.h"

namespace saw_ndt {

/// The map of the scans of several map files, as WeightedMapBuilder::merge() makes it; their order does not matter. The
/// files are read tile by tile, side by side.
/// @param paths    one or more
/// @param threads  0: all cores; the map does not depend on it
/// @throws Error where a file cannot be read, is given twice, under whatever name, or does not merge with the first
/// one: it names both and says what differs. std::invalid_argument where there is no path
SAW_NDT_EXPORT WeightedVoxelMap mergeMapFiles(const std::vector<std::string>& paths, int threads = 0);

/// A merged map that was written.
struct MergedMap : WrittenMap {
  std::uint64_t dead_bytes_left_out = 0;  ///< of the files: what updates had replaced (see map_update.h)
};

/// Writes the map file of the same map, a few tiles at a time: memory does not grow with the maps but for 40 bytes a
/// tile. Of one file, the map without what updates have left dead in it.
/// @param out_path  may be one of `paths`
/// @throws Error as above, and where the file cannot be written: `out_path` is as it was then
SAW_NDT_EXPORT MergedMap mergeMapFiles(const std::vector<std::string>& paths, const std::string& out_path,
                                       int threads = 0);

}  // namespace saw_ndt
