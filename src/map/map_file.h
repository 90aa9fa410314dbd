#pragma once

#include <string>
#include <vector>

#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt {

// The map file, version 1, little-endian throughout:
//
//   header     96 bytes: magic "SAWNDTM\n", u32 version, u32 header bytes, f64 resolution (m), u32 tile size (voxels),
//              u32 flags (bit 0: labelled), u64 scans, u64 points, u64 entries, u64 tiles, u32 CRC-32 of the directory,
//              24 bytes zero, u32 CRC-32 of the header before it
//   directory  40 bytes a tile, ordered by z, y, x: i32 x y z, u32 CRC-32 of the tile's entries, u64 entries,
//              u64 offset in the file, u64 zero
//   entries    84 bytes each, tile after tile, ordered by z, y, x, label: u8 x y z within the tile, u8 label, u64
//   count,
//              i64 sum x y z, i64 product xx xy xz yy yz zz (VoxelSums)
//
// Means, covariances, confidences and weights follow exactly from the sums and are not repeated. With the directory in
// front, the tiles of a region can be found and checked without reading any other.

/// What a map file holds.
struct MapFileContent {
  MapOrigin origin;
  std::vector<LabelledVoxelSums> entries;  ///< in map order
};

/// @param entries  in map order (see map_tile.h)
/// @throws Error where the file cannot be written; nothing is left behind then
void writeMapFile(const std::string& path, const MapOrigin& origin, const std::vector<LabelledVoxelSums>& entries);

/// @throws Error that names the offset and the reason where the file is missing, truncated, damaged, of another version
/// or no map at all; sizes are checked against the file's own before anything is allocated
MapFileContent readMapFile(const std::string& path);

}  // namespace saw_ndt
