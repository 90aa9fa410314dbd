#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "map/voxel_sums_table.h"

namespace saw_ndt::internal {

/// The order of a table's entries by tile: four bytes an entry, where a sorted copy takes a hundred. Valid as long as
/// nothing is added to the table.
class TiledEntries {
 public:
  explicit TiledEntries(const VoxelSumsTable& table);

  /// How many tiles (see map_tile.h) have entries.
  std::size_t tileCount() const { return tiles_.size(); }
  /// Coordinate of a tile; tiles are numbered in map order.
  const Eigen::Vector3i& coordinate(std::size_t tile) const { return tiles_[tile].coordinate; }
  std::size_t entryCount(std::size_t tile) const { return tiles_[tile].end - tiles_[tile].first; }

  /// Replaces `entries` by those of a tile, in map order. May be called by several threads at a time.
  void read(std::size_t tile, std::vector<LabelledVoxelSums>& entries) const;

 private:
  struct Tile {
    Eigen::Vector3i coordinate;
    std::size_t first, end;  // in places_
  };

  const VoxelSumsTable& table_;
  std::vector<Tile> tiles_;
  std::vector<std::uint32_t> places_;  // in the table, tile after tile
};

}  // namespace saw_ndt::internal
