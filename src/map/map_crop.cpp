#include "saw_ndt/map/map_crop.h"

#include <utility>
#include <vector>

#include "map/map_file.h"
#include "map/map_file_writer.h"
#include "map/region_tiles.h"
#include "map/sums_statistics.h"
#include "map/tile_batches.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {
namespace {

using namespace internal;

struct NoScratch {};

// The tiles of which some voxel is kept. Hardly more than one entry of most of them has to be looked at.
std::vector<RegionTile> tilesKept(const MapFileReader& reader, const MapRegion& region, int threads) {
  std::vector<RegionTile> kept;
  RegionTiles tiles(reader, region);
  forEachTileInBatches<RegionTile, NoScratch, char>(
      threads, [&tiles](RegionTile& tile) { return tiles.next(tile); },
      [&](const RegionTile& tile, NoScratch&, char& is_kept) {
        const MapTileRecord record = reader.front().tile(tile.place);
        is_kept = 0;
        for (std::uint64_t i = 0; i < record.entry_count && is_kept == 0; ++i) {
          is_kept = region(centreOf(reader.voxelOf(record, i), reader.origin().resolution_m)) ? 1 : 0;
        }
        reader.forget(record);
      },
      [&](const RegionTile& tile, char is_kept) {
        if (is_kept != 0) kept.push_back(tile);
      });
  return kept;
}

struct CropScratch {
  std::vector<LabelledVoxelSums> whole, kept;
};

struct CroppedTile {
  MapTileRecord record;
  std::vector<char> bytes;
  std::uint64_t voxel_count = 0, point_count = 0;
};

}  // namespace

WeightedVoxelMap cropMap(const WeightedVoxelMap& map, const MapRegion& region) {
  std::vector<LabelledVoxelSums> kept;
  MapOrigin origin = map.origin();
  origin.point_count = 0;
  const LabelledVoxelSums* const first = map.entries().data();
  forEachEntryIn(region, map.resolution(), first, first + map.entries().size(), [&](const LabelledVoxelSums& entry) {
    kept.push_back(entry);
    origin.point_count += entry.sums.count;
  });
  return {origin, std::move(kept)};
}

CroppedMap cropMapFile(const std::string& path, const MapRegion& region, const std::string& out_path, int threads) {
  MapFileReader reader(path);
  CroppedMap written;
  written.origin = reader.origin();
  written.point_count_before = written.origin.point_count;
  written.origin.point_count = 0;
  const std::vector<RegionTile> tiles = tilesKept(reader, region, threads);
  if (tiles.empty()) throw Error(path, "", "none of its voxels lies there: nothing is left");
  MapFileWriter writer(out_path, written.origin, tiles.size());
  auto next = tiles.begin();
  forEachTileInBatches<RegionTile, CropScratch, CroppedTile>(
      threads,
      [&](RegionTile& tile) {
        if (next == tiles.end()) return false;
        tile = *next++;
        return true;
      },
      [&](const RegionTile& tile, CropScratch& scratch, CroppedTile& cropped) {
        decodeTileIn(reader, tile.place, region, scratch.whole, scratch.kept);
        const LabelledVoxelSums* const first = scratch.kept.data();
        const LabelledVoxelSums* const last = first + scratch.kept.size();
        cropped.record = encodeTile(first, last, cropped.bytes);
        cropped.voxel_count = voxelCountOf(first, last, written.origin.resolution_m);
        cropped.point_count = pointCountOf(first, last);
      },
      [&](const RegionTile&, const CroppedTile& cropped) {
        writer.add(cropped.record, cropped.bytes);
        written.voxel_count += cropped.voxel_count;
        written.entry_count += cropped.record.entry_count;
        written.origin.point_count += cropped.point_count;
      });
  writer.commit(written.origin.point_count);
  written.tile_count = tiles.size();
  written.file_bytes = writer.size();
  return written;
}

}  // namespace saw_ndt
