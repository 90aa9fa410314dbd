#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "map/map_tile.h"

namespace saw_ndt::internal {

/// Sums that are kept in a temporary file instead of in memory, in parts of tiles: a part has the sums of a tile from
/// some of the scans. Copies share the file, and each knows its own parts.
class SpilledTiles {
 public:
  /// Makes a file without a name in a folder. @throws Error
  explicit SpilledTiles(const std::filesystem::path& folder);

  /// Adds a part. @param entries  of one tile, at least one. @throws Error with the system's reason, such as a full
  /// disk
  void add(const std::vector<LabelledVoxelSums>& entries);
  /// Forgets all parts; the room that they take is not given back.
  void clear() { parts_.clear(); }

  /// The parts as encodeTile() tells them, with their offset in the file, in the order in which they were added.
  const std::vector<MapTileRecord>& parts() const { return parts_; }
  /// Appends the entries of a part. May be called by several threads at a time. @throws Error
  void read(const MapTileRecord& part, std::vector<LabelledVoxelSums>& entries) const;

 private:
  class File;

  std::shared_ptr<File> file_;
  std::vector<MapTileRecord> parts_;
};

}  // namespace saw_ndt::internal
