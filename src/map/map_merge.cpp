#include "saw_ndt/map/map_merge.h"

#include <stdexcept>
#include <utility>

#include "map/map_file_writer.h"
#include "map/tile_merge.h"

namespace saw_ndt {

using namespace internal;

namespace {

void requireSome(const std::vector<std::string>& paths) {
  if (paths.empty()) throw std::invalid_argument("paths: no map to merge");
}

}  // namespace

WeightedVoxelMap mergeMapFiles(const std::vector<std::string>& paths, int threads) {
  requireSome(paths);
  TileMerge files(paths);
  std::vector<LabelledVoxelSums> entries;
  files.mergeTiles(false, false, threads, [&entries](const TileSources&, const MergedTile& tile) {
    entries.insert(entries.end(), tile.entries.begin(), tile.entries.end());
  });
  return {files.origin(), std::move(entries)};
}

MergedMap mergeMapFiles(const std::vector<std::string>& paths, const std::string& out_path, int threads) {
  requireSome(paths);
  TileMerge files(paths);
  MergedMap written;
  written.origin = files.origin();
  written.dead_bytes_left_out = files.deadBytes();
  files.forEachTile([&written](const TileSources&) { ++written.tile_count; });
  MapFileWriter writer(out_path, written.origin, written.tile_count);
  files.mergeTiles(false, true, threads, [&](const TileSources&, const MergedTile& tile) {
    writer.add(tile.record, tile.bytes);
    written.voxel_count += tile.voxel_count;
    written.entry_count += tile.record.entry_count;
  });
  writer.commit(written.origin.point_count);
  written.file_bytes = writer.size();
  return written;
}

}  // namespace saw_ndt
