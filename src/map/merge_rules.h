#pragma once

#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt::internal {

// What holds where maps are put together, whether in memory or tile by tile. A map holds something where it has scans
// or entries.

/// @param into_holds  whether the map merged into holds something
/// @throws std::invalid_argument that names what differs, where maps do not merge
void requireMergeable(const MapOrigin& into, bool into_holds, const MapOrigin& from, bool from_holds);

/// Begins to add points of a kind and version: an empty map takes them over, another one no longer tells versions that
/// differ.
void beginAdding(MapOrigin& into, bool into_holds, bool labelled, const std::string& software_version);

/// Adds what a map that holds something was made of.
void addOrigin(MapOrigin& into, bool into_holds, const MapOrigin& from);

/// Adds the count of the scans that met a voxel; to be called before the sums are added. The order of additions does
/// not matter. 0: not known of some of the points.
void addScanCount(const LabelledVoxelSums& from, LabelledVoxelSums& into);

/// Throws std::invalid_argument where the points of two entries of a voxel are more than there is room for.
void requireRoomFor(const VoxelSums& from, const VoxelSums& into);

}  // namespace saw_ndt::internal
