#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt {

/// What an update of a map file did.
struct MapUpdate {
  MapOrigin origin;                  ///< of the map as it is now
  std::uint64_t tiles_met = 0;       ///< that the maps added have entries of
  std::uint64_t tiles_new = 0;       ///< of these, those that the map did not have
  std::uint64_t bytes_appended = 0;  ///< tiles and a new directory
  std::uint64_t file_bytes = 0;
  std::uint64_t dead_bytes = 0;  ///< of these, those that updates have replaced
};

/// Adds the scans of map files to a map file in place: it becomes the map of mergeMapFiles() of all of them, and its
/// scans must not be among those added. Only the tiles that the added maps meet are read and written: they are appended
/// to the file, behind them a new directory, and the header that makes all of it hold is replaced last, once the rest
/// is safe on the disk. Whatever ends the process or the machine in between, the file is the old map or the new one,
/// whole, and who has it open reads on what it was. What was replaced stays in the file as dead bytes until the map is
/// merged alone into a new file. Time and memory do not grow with the map but for its directory of 40 bytes a tile.
/// @param path     of the map to update: a regular file of version 2 or later. Not for several updates at a time: they
///                 lock the file
/// @param added    one or more
/// @param threads  0: all cores; the file does not depend on it
/// @throws Error where a file cannot be read or written, is given twice, under whatever name, or does not merge with
/// the map, and where another update holds the lock: the map is as it was then. std::invalid_argument where nothing is
/// added
SAW_NDT_EXPORT MapUpdate updateMapFile(const std::string& path, const std::vector<std::string>& added, int threads = 0);

/// How many bytes of a map file do not belong to the map, since updates have replaced them or were broken off.
/// @throws Error where the file is missing, damaged, truncated or foreign
SAW_NDT_EXPORT std::uint64_t deadBytesOfMapFile(const std::string& path);

}  // namespace saw_ndt
