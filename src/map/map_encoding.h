#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt::internal {

/// What the directory of a map file tells of a tile.
struct MapTileRecord {
  Eigen::Vector3i coordinate = Eigen::Vector3i::Zero();  ///< see tileOf()
  std::uint32_t checksum = 0;                            ///< CRC-32 of the entries' bytes
  std::uint64_t entry_count = 0;
  std::uint64_t offset = 0;  ///< of the entries in the file
};

/// Entries of one tile as the bytes that stand in a map file.
/// @param first, last  entries of one tile in map order, at least one
/// @param bytes        replaced
/// @return the tile's record, but for its offset
SAW_NDT_EXPORT MapTileRecord encodeTile(const LabelledVoxelSums* first, const LabelledVoxelSums* last,
                                        std::vector<char>& bytes);

/// How many bytes of a map file so many entries are.
SAW_NDT_EXPORT std::uint64_t bytesOfEntries(std::uint64_t entry_count);

/// What stands before the entries of a map file: header, metadata and directory.
/// @param tiles  all of the map, in map order, with their offsets
SAW_NDT_EXPORT std::string encodeFront(const MapOrigin& origin, const std::vector<MapTileRecord>& tiles);

/// How many bytes that is, where the entries of the first tile begin. Neither scan_count nor point_count matters.
SAW_NDT_EXPORT std::uint64_t bytesOfFront(const MapOrigin& origin, std::uint64_t tile_count);

}  // namespace saw_ndt::internal
