#include "saw_ndt/map/map_update.h"

#include <stdexcept>

#include "common/growing_file.h"
#include "map/map_encoding.h"
#include "map/map_file_layout.h"
#include "map/tile_merge.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {

using namespace internal;

namespace {

// Writes behind the end of a map file. Until the header is switched, nothing that it tells of changes, and without that
// all is as it was.
class Update {
 public:
  Update(GrowingFile& file, const MapFileReader& map)
      : file_(file), header_before_(map.header()), end_before_(map.front().endOffset()), end_(end_before_) {
    if (map.front().version() == kUpdatedMapVersion) return;
    // From now on there may be something behind the end.
    const std::string header = asUpdatedHeader(header_before_, end_before_);
    file_.write(0, header.data(), header.size());
    file_.sync();
  }
  ~Update() {
    if (switched_) return;
    try {
      file_.resize(end_before_);
      file_.sync();
      file_.write(0, header_before_.data(), header_before_.size());
    } catch (const Error&) {
      // What is behind the end stays there.
    }
  }
  Update(const Update&) = delete;
  Update& operator=(const Update&) = delete;

  std::uint64_t end() const { return end_; }

  void append(const char* bytes, std::uint64_t count) {
    file_.write(end_, bytes, count);
    end_ += count;
  }

  void commit(const MapOrigin& origin, const std::vector<MapTileRecord>& tiles) {
    const MapSwitch to = encodeSwitch(origin, tiles, end_);
    append(to.metadata_and_directory.data(), to.metadata_and_directory.size());
    // A longer rest of an update that was broken off.
    file_.resize(end_);
    file_.sync();
    file_.requireStillThere();
    switched_ = true;
    file_.write(0, to.header.data(), to.header.size());
    file_.sync();
  }

 private:
  GrowingFile& file_;
  std::string header_before_;
  std::uint64_t end_before_;
  std::uint64_t end_;
  bool switched_ = false;
};

// The directory of a map of which some tiles were replaced and some are new, both in map order.
std::vector<MapTileRecord> withTiles(const MapFront& map, const std::vector<MapTileRecord>& written) {
  std::vector<MapTileRecord> tiles;
  tiles.reserve(map.tileCount() + written.size());
  auto next = written.begin();
  for (std::uint64_t i = 0; i < map.tileCount(); ++i) {
    const MapTileRecord tile = map.tile(i);
    while (next != written.end() && tileInMapOrder(next->coordinate, tile.coordinate)) tiles.push_back(*next++);
    const bool replaced = next != written.end() && next->coordinate == tile.coordinate;
    tiles.push_back(replaced ? *next++ : tile);
  }
  tiles.insert(tiles.end(), next, written.end());
  return tiles;
}

}  // namespace

MapUpdate updateMapFile(const std::string& path, const std::vector<std::string>& added, int threads) {
  if (added.empty()) throw std::invalid_argument("added: no map to add");
  std::vector<std::string> paths = added;
  paths.insert(paths.begin(), path);
  GrowingFile file(path);
  TileMerge files(paths);
  file.requireStillThere();
  const MapFileReader& map = files.file(0);
  if (map.front().version() == kFirstMapVersion) {
    throw Error(path, "", "map version 1 is not updated in place: merge it into a new file");
  }
  MapUpdate result;
  result.origin = files.origin();
  if (files.othersHold()) {
    Update update(file, map);
    std::vector<MapTileRecord> written;
    files.mergeTiles(true, true, threads, [&](const TileSources& sources, const MergedTile& tile) {
      written.push_back(tile.record);
      written.back().offset = update.end();
      update.append(tile.bytes, bytesOfEntries(tile.record.entry_count));
      if (sources.sources.front().file != 0) ++result.tiles_new;
    });
    update.commit(result.origin, withTiles(map.front(), written));
    result.tiles_met = written.size();
    result.bytes_appended = update.end() - map.front().endOffset();
  } else {
    result.origin = map.origin();
  }
  const MapFileReader updated(path);
  result.file_bytes = updated.front().endOffset();
  result.dead_bytes = updated.front().deadBytes();
  return result;
}

std::uint64_t deadBytesOfMapFile(const std::string& path) { return MapFileReader(path).front().deadBytes(); }

}  // namespace saw_ndt
