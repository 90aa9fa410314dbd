#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/atomic_output.h"
#include "map/map_encoding.h"
#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// Writes a map file a tile at a time: in memory are the records of the tiles alone. Without commit() the file stays as
/// it was and nothing is left behind. Not for several threads at a time.
class SAW_NDT_EXPORT MapFileWriter {
 public:
  /// @param path        of the map file (see map_file.h)
  /// @param origin      of the map; commit() tells how many points it has
  /// @param tile_count  that will be added; the directory before them has room for so many
  /// @throws Error where the file cannot be written
  MapFileWriter(const std::string& path, const MapOrigin& origin, std::uint64_t tile_count);

  /// Adds the next tile in map order, by its entries.
  /// @param first, last  entries of one tile in map order, at least one
  void add(const LabelledVoxelSums* first, const LabelledVoxelSums* last);
  /// Adds the next tile in map order, as encodeTile() made it; its offset does not matter.
  void add(MapTileRecord tile, const std::vector<char>& bytes) { add(tile, bytes.data()); }
  void add(MapTileRecord tile, const char* bytes);

  /// How many bytes have been written, those of the front included.
  std::uint64_t size() const { return size_; }

  /// Writes what comes before the tiles, and lets the file appear. To be called once.
  /// @param point_count  of all tiles
  /// @throws Error with the system's reason, such as a full disk; std::logic_error where other than `tile_count` tiles
  /// were added, or not in map order
  void commit(std::uint64_t point_count);

 private:
  AtomicOutput output_;
  MapOrigin origin_;
  std::uint64_t tile_count_;
  std::uint64_t size_;
  std::vector<MapTileRecord> tiles_;
  std::vector<char> bytes_;  // of a tile
};

}  // namespace saw_ndt::internal
