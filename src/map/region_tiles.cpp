#include "map/region_tiles.h"

#include "map/map_encoding.h"

namespace saw_ndt::internal {
namespace {

Eigen::AlignedBox3d boxOf(const MapTileRecord& tile, double resolution_m) {
  const Eigen::Array3d least = tile.coordinate.cast<double>() * kTileSize;
  return {(least * resolution_m).matrix(), ((least + kTileSize) * resolution_m).matrix()};
}

}  // namespace

bool RegionTiles::next(RegionTile& tile) {
  for (; next_ < reader_.tileCount(); ++next_) {
    const MapTileRecord record = reader_.front().tile(next_);
    if (record.entry_count == 0 || !region_.mayMeet(boxOf(record, reader_.origin().resolution_m))) continue;
    tile = {next_++, bytesOfEntries(record.entry_count)};
    return true;
  }
  return false;
}

void decodeTileIn(MapFileReader& reader, std::uint64_t place, const MapRegion& region,
                  std::vector<LabelledVoxelSums>& scratch, std::vector<LabelledVoxelSums>& entries) {
  reader.decodeTile(place, scratch);
  reader.forget(reader.front().tile(place));
  entries.clear();
  forEachEntryIn(region, reader.origin().resolution_m, scratch.data(), scratch.data() + scratch.size(),
                 [&entries](const LabelledVoxelSums& entry) { entries.push_back(entry); });
}

}  // namespace saw_ndt::internal
