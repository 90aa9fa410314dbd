#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "map/map_file.h"
#include "map/map_tile.h"

namespace saw_ndt::internal {

/// A tile as files hold it.
struct TileSources {
  struct Source {
    std::size_t file = 0;
    std::uint64_t tile = 0;  ///< its place in the file's directory
  };

  Eigen::Vector3i coordinate = Eigen::Vector3i::Zero();
  std::vector<Source> sources;   ///< those that have entries of it, in the order of the files
  std::uint64_t byte_count = 0;  ///< of the entries in all of them
};

/// A tile of the map that is merged.
struct MergedTile {
  std::vector<LabelledVoxelSums> entries;  ///< none where bytes were asked for
  MapTileRecord record;                    ///< likewise what encodeTile() tells, and null for the bytes, where not
  const char* bytes = nullptr;
  std::uint64_t voxel_count = 0;
  std::vector<char> encoded;  ///< memory of the bytes, where they do not stand in a file
};

/// Merges map files tile by tile, walking their directories together: memory is that of a few megabytes of tiles,
/// whatever the maps' size.
class TileMerge {
 public:
  /// Opens the files.
  /// @param paths  one or more
  /// @throws Error where a file cannot be read, is given twice, under whatever name, or does not merge with the first
  /// one: it names both and says what differs
  explicit TileMerge(const std::vector<std::string>& paths);

  /// What the merged map is made of.
  const MapOrigin& origin() const { return origin_; }
  const MapFileReader& file(std::size_t file) const { return *files_[file]; }
  /// Of all files, see MapFront.
  std::uint64_t deadBytes() const;
  /// Whether any file but the first one holds something.
  bool othersHold() const { return others_hold_; }

  /// Calls visit(sources) for every tile that has entries, in map order.
  void forEachTile(const std::function<void(const TileSources&)>& visit) const;

  /// Calls take(sources, tile) for each of these tiles, in map order, with the entries of all files merged, or their
  /// bytes where `encodes`.
  /// @param met_by_others  only tiles that a file but the first one has entries of
  /// @throws Error where a file is damaged, or a voxel would have more points than there is room for
  void mergeTiles(bool met_by_others, bool encodes, int threads,
                  const std::function<void(const TileSources&, const MergedTile&)>& take);

 private:
  class Walk;
  struct Scratch {
    std::vector<LabelledVoxelSums> entries, of_one_file, before;
  };

  void merge(const TileSources& sources, bool encodes, Scratch& scratch, MergedTile& merged);
  void addFile(std::size_t file, Scratch& scratch) const;
  [[noreturn]] void failToMerge(std::size_t file, const std::string& reason) const;

  std::vector<std::unique_ptr<MapFileReader>> files_;
  MapOrigin origin_;
  bool others_hold_ = false;
};

}  // namespace saw_ndt::internal
