#include "map/tile_merge.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "map/map_encoding.h"
#include "map/merge_rules.h"
#include "map/sums_statistics.h"
#include "map/tile_batches.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/version.h"

namespace saw_ndt::internal {
namespace {

void requireDifferentFiles(const std::vector<std::string>& paths) {
  std::map<std::filesystem::path, std::string> met;
  for (const std::string& path : paths) {
    std::error_code error;
    const std::filesystem::path canonical = std::filesystem::canonical(path, error);
    if (error) throw Error(path, "", error.message());
    const auto [other, is_new] = met.emplace(canonical, path);
    if (!is_new) {
      throw Error(path, "",
                  "is given twice" + (other->second == path ? "" : ", also as " + other->second) +
                      ": its scans would count twice");
    }
  }
}

bool holdsSomething(const MapFileReader& file) { return file.origin().scan_count != 0 || file.entryCount() != 0; }

}  // namespace

/// Walks the directories together.
class TileMerge::Walk {
 public:
  explicit Walk(const std::vector<std::unique_ptr<MapFileReader>>& files) : files_(files), next_(files.size(), 0) {
    for (std::size_t file = 0; file < files.size(); ++file) {
      records_.emplace_back();
      advance(file);
    }
  }

  bool next(TileSources& tile) {
    const MapTileRecord* first = nullptr;
    for (std::size_t file = 0; file < files_.size(); ++file) {
      if (isBehind(file)) continue;
      if (first == nullptr || tileInMapOrder(records_[file].coordinate, first->coordinate)) first = &records_[file];
    }
    if (first == nullptr) return false;
    tile.coordinate = first->coordinate;
    tile.sources.clear();
    tile.byte_count = 0;
    for (std::size_t file = 0; file < files_.size(); ++file) {
      if (isBehind(file) || records_[file].coordinate != tile.coordinate) continue;
      tile.sources.push_back({file, next_[file]});
      tile.byte_count += bytesOfEntries(records_[file].entry_count);
      ++next_[file];
      advance(file);
    }
    return true;
  }

 private:
  bool isBehind(std::size_t file) const { return next_[file] == files_[file]->tileCount(); }

  // To the next tile with entries.
  void advance(std::size_t file) {
    for (; !isBehind(file); ++next_[file]) {
      records_[file] = files_[file]->front().tile(next_[file]);
      if (records_[file].entry_count != 0) return;
    }
  }

  const std::vector<std::unique_ptr<MapFileReader>>& files_;
  std::vector<std::uint64_t> next_;
  std::vector<MapTileRecord> records_;  // at these places
};

TileMerge::TileMerge(const std::vector<std::string>& paths) {
  requireDifferentFiles(paths);
  for (const std::string& path : paths) files_.push_back(std::make_unique<MapFileReader>(path));
  origin_.resolution_m = files_.front()->origin().resolution_m;
  origin_.segmentation = files_.front()->origin().segmentation;
  origin_.software_version = SAW_NDT_VERSION;
  bool holds = false;
  for (std::size_t file = 0; file < files_.size(); ++file) {
    const bool adds = holdsSomething(*files_[file]);
    try {
      requireMergeable(origin_, holds, files_[file]->origin(), adds);
    } catch (const std::invalid_argument& error) {
      failToMerge(file, error.what());
    }
    if (!adds) continue;
    addOrigin(origin_, holds, files_[file]->origin());
    holds = true;
    others_hold_ = others_hold_ || file > 0;
  }
}

void TileMerge::failToMerge(std::size_t file, const std::string& reason) const {
  throw Error(files_[file]->path(), "", "does not merge with " + files_.front()->path() + ": " + reason);
}

std::uint64_t TileMerge::deadBytes() const {
  std::uint64_t bytes = 0;
  for (const auto& file : files_) bytes += file->front().deadBytes();
  return bytes;
}

void TileMerge::forEachTile(const std::function<void(const TileSources&)>& visit) const {
  TileSources tile;
  for (Walk walk(files_); walk.next(tile);) visit(tile);
}

void TileMerge::mergeTiles(bool met_by_others, bool encodes, int threads,
                           const std::function<void(const TileSources&, const MergedTile&)>& take) {
  Walk walk(files_);
  forEachTileInBatches<TileSources, Scratch, MergedTile>(
      threads,
      [&](TileSources& tile) {
        do {
          if (!walk.next(tile)) return false;
        } while (met_by_others && tile.sources.back().file == 0);
        return true;
      },
      [&](const TileSources& sources, Scratch& scratch, MergedTile& merged) {
        merge(sources, encodes, scratch, merged);
      },
      [&](const TileSources& sources, const MergedTile& merged) {
        take(sources, merged);
        for (const TileSources::Source& source : sources.sources) {
          files_[source.file]->forget(files_[source.file]->front().tile(source.tile));
        }
      });
  for (std::size_t file = met_by_others ? 1 : 0; file < files_.size(); ++file) files_[file]->checkEnd();
}

void TileMerge::merge(const TileSources& sources, bool encodes, Scratch& scratch, MergedTile& merged) {
  const TileSources::Source& first = sources.sources.front();
  files_[first.file]->decodeTile(first.tile, scratch.entries);
  for (std::size_t i = 1; i < sources.sources.size(); ++i) {
    const TileSources::Source& source = sources.sources[i];
    files_[source.file]->decodeTile(source.tile, scratch.of_one_file);
    addFile(source.file, scratch);
  }
  const LabelledVoxelSums* const begin = scratch.entries.data();
  const LabelledVoxelSums* const end = begin + scratch.entries.size();
  merged.voxel_count = voxelCountOf(begin, end, origin_.resolution_m);
  if (!encodes) {
    merged.entries = scratch.entries;
    return;
  }
  if (sources.sources.size() == 1) {
    // Entries that have been decoded are encoded to the same bytes, of whatever version they were.
    merged.record = files_[first.file]->front().tile(first.tile);
    merged.bytes = files_[first.file]->bytesOf(merged.record);
  } else {
    merged.record = encodeTile(begin, end, merged.encoded);
    merged.bytes = merged.encoded.data();
  }
}

// Merges the entries of another file, both in map order.
void TileMerge::addFile(std::size_t file, Scratch& scratch) const {
  scratch.before.swap(scratch.entries);
  scratch.entries.clear();
  auto from = scratch.of_one_file.cbegin();
  for (LabelledVoxelSums& into : scratch.before) {
    while (from != scratch.of_one_file.cend() && inMapOrder(*from, into)) scratch.entries.push_back(*from++);
    if (from != scratch.of_one_file.cend() && !inMapOrder(into, *from)) {
      try {
        requireRoomFor(from->sums, into.sums);
      } catch (const std::invalid_argument& error) {
        failToMerge(file, error.what());
      }
      addScanCount(*from, into);
      into.sums += from->sums;
      ++from;
    }
    scratch.entries.push_back(into);
  }
  scratch.entries.insert(scratch.entries.end(), from, scratch.of_one_file.cend());
}

}  // namespace saw_ndt::internal
