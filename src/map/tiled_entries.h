#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "map/map_encoding.h"
#include "map/spilled_tiles.h"
#include "map/tile_batches.h"
#include "map/voxel_sums_table.h"

namespace saw_ndt::internal {

/// The order of the entries of a table by tile: four bytes an entry, where a sorted copy takes a hundred. What has been
/// spilled of the table comes together with it. Valid as long as nothing is added to either.
class TiledEntries {
 public:
  /// @param spilled  may be null
  TiledEntries(const VoxelSumsTable& table, const SpilledTiles* spilled);

  /// How many tiles (see map_tile.h) have entries. They are numbered in map order.
  std::size_t tileCount() const { return tiles_.size(); }

  /// Replaces `entries` by those of a tile, in map order. May be called by several threads at a time.
  /// @throws Error as SpilledTiles::read(); std::invalid_argument where a voxel would have more points than there is
  /// room for
  void read(std::size_t tile, std::vector<LabelledVoxelSums>& entries) const;

  /// Reads all tiles: prepare(entries, result) by several threads at a time, finish(result) in map order.
  /// @param threads  0: all cores
  template <typename Result, typename Prepare, typename Finish>
  void forEach(int threads, const Prepare& prepare, const Finish& finish) const {
    struct Task {
      std::size_t tile = 0;
      std::uint64_t byte_count = 0;
    };
    using Entries = std::vector<LabelledVoxelSums>;
    std::size_t next = 0;
    forEachTileInBatches<Task, Entries, Result>(
        threads,
        [&](Task& task) {
          if (next == tiles_.size()) return false;
          task = {next, bytesOfEntries(entryCount(next))};
          ++next;
          return true;
        },
        [&](const Task& task, Entries& entries, Result& result) {
          read(task.tile, entries);
          prepare(entries, result);
        },
        [&](const Task&, const Result& result) { finish(result); });
  }

 private:
  struct Tile {
    Eigen::Vector3i coordinate;
    std::size_t first_place, end_place;  // in places_
    std::size_t first_part, end_part;    // in parts_
  };

  // Those of a voxel and label that are in several parts count as many.
  std::uint64_t entryCount(std::size_t tile) const;

  const VoxelSumsTable& table_;
  const SpilledTiles* spilled_;
  std::vector<Tile> tiles_;
  std::vector<std::uint32_t> places_;  // in the table, tile after tile
  std::vector<std::uint32_t> parts_;   // of what has been spilled, tile after tile
};

/// Calls visit(entries) for each tile in map order.
void forEachTileOf(const VoxelSumsTable& table, const SpilledTiles* spilled,
                   const std::function<void(const std::vector<LabelledVoxelSums>& entries)>& visit, int threads = 1);

}  // namespace saw_ndt::internal
