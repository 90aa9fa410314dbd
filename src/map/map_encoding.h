#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "map/map_tile.h"
#include "saw_ndt/common/export.h"
#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt::internal {

struct MapEntryLayout;

/// Entries of one tile as the bytes that stand in a map file.
/// @param first, last  entries of one tile in map order, at least one
/// @param bytes        replaced
/// @return the tile's record, but for its offset
SAW_NDT_EXPORT MapTileRecord encodeTile(const LabelledVoxelSums* first, const LabelledVoxelSums* last,
                                        std::vector<char>& bytes);

/// An entry as it stands there, whether it can be one or not.
SAW_NDT_EXPORT LabelledVoxelSums decodeEntry(const MapEntryLayout& layout, const Eigen::Vector3i& tile);

/// How many bytes of a map file so many entries are.
SAW_NDT_EXPORT std::uint64_t bytesOfEntries(std::uint64_t entry_count);

/// What stands before the entries of a new map file: header, metadata and directory.
/// @param tiles  all of the map, in map order, with their offsets
SAW_NDT_EXPORT std::string encodeFront(const MapOrigin& origin, const std::vector<MapTileRecord>& tiles);

/// What an update appends to a map file behind the tiles, and the header that makes it hold.
struct MapSwitch {
  std::string header;
  std::string metadata_and_directory;
};
/// @param front_offset  where the metadata are to stand
MapSwitch encodeSwitch(const MapOrigin& origin, const std::vector<MapTileRecord>& tiles, std::uint64_t front_offset);

/// The header of a file of version 2 or 3 as that of a file that may be updated: the same map, which ends somewhere.
std::string asUpdatedHeader(const std::string& header, std::uint64_t end_offset);

/// How many bytes encodeFront() gives, where the entries of the first tile begin. Neither scan_count nor point_count
/// matters.
SAW_NDT_EXPORT std::uint64_t bytesOfFront(const MapOrigin& origin, std::uint64_t tile_count);

}  // namespace saw_ndt::internal
