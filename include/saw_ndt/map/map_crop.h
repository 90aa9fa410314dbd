#pragma once

#include <cstdint>
#include <string>

#include "saw_ndt/common/export.h"
#include "saw_ndt/map/map_region.h"
#include "saw_ndt/map/weighted_voxel_map.h"
#include "saw_ndt/map/written_map.h"

namespace saw_ndt {

/// The voxels of a map whose centres belong to a region, whole and with their sums unchanged; none where none belongs.
/// Parts of a map that share no voxel merge into its entries again. Of the origin, point_count is that of the points
/// kept; scan_count stays that of the map, for which scans left no points is not known.
SAW_NDT_EXPORT WeightedVoxelMap cropMap(const WeightedVoxelMap& map, const MapRegion& region);

/// A part of a map that was written.
struct CroppedMap : WrittenMap {
  std::uint64_t point_count_before = 0;  ///< of the whole map
};

/// Writes the map file of cropMap() of a map file, a few tiles at a time: memory does not grow with the map or with
/// what is kept but for 40 bytes a tile, and of the file only the tiles that can meet the region are read.
/// @param out_path  may be `path`
/// @param threads   0: all cores; the file does not depend on it
/// @throws Error where a file cannot be read or written, or no voxel belongs; `out_path` is as it was then
SAW_NDT_EXPORT CroppedMap cropMapFile(const std::string& path, const MapRegion& region, const std::string& out_path,
                                      int threads = 0);

}  // namespace saw_ndt
