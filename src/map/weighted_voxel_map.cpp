#include "saw_ndt/map/weighted_voxel_map.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "map/map_file.h"
#include "map/map_metadata.h"
#include "map/map_order.h"
#include "map/map_tile.h"
#include "map/region_tiles.h"
#include "map/resolution_range.h"
#include "map/sums_statistics.h"
#include "map/tile_batches.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {

using namespace internal;

namespace {

double metresPerStep(const MapOrigin& origin) { return origin.resolution_m / kStepsPerVoxel; }

}  // namespace

void MapOrigin::check() const {
  checkOption(isResolution(resolution_m), "resolution_m", resolution_m, "positive, from 1e-9 to 1e9");
  if (segmentation) segmentation->check();
  checkOption(software_version.find('\n') == std::string::npos, "software_version", software_version,
              "without line breaks");
  checkOption(map_origin_m.allFinite(), "map_origin_m", positionText(map_origin_m), "finite");
}

WeightedVoxelMap::WeightedVoxelMap(const MapOrigin& origin, std::vector<LabelledVoxelSums> entries)
    : origin_((origin.check(), origin)), entries_(std::move(entries)) {
  if (!std::is_sorted(entries_.begin(), entries_.end(), internal::inMapOrder)) internal::sortIntoMapOrder(entries_);
  const auto not_ascending = [](const LabelledVoxelSums& a, const LabelledVoxelSums& b) {
    return !internal::inMapOrder(a, b);
  };
  if (std::adjacent_find(entries_.begin(), entries_.end(), not_ascending) != entries_.end()) {
    throw std::invalid_argument("entries: a voxel and label is given twice");
  }
}

std::vector<VoxelStatistics> WeightedVoxelMap::statistics(const VoxelWeighting& weighting, int threads) const {
  weighting.check();
  std::vector<std::vector<VoxelStatistics>> parts;
  internal::forEachPartOfVoxels(
      entries_, threads, [&parts](std::size_t part_count) { parts.resize(part_count); },
      [&](std::size_t part, const LabelledVoxelSums* first, const LabelledVoxelSums* last) {
        internal::forEachStatistics(first, last, weighting, {}, metresPerStep(origin_),
                                    [&](const std::vector<VoxelStatistics>& batch) {
                                      parts[part].insert(parts[part].end(), batch.begin(), batch.end());
                                    });
      });
  std::vector<VoxelStatistics> whole = std::move(parts.front());
  for (std::size_t part = 1; part < parts.size(); ++part) {
    whole.insert(whole.end(), parts[part].begin(), parts[part].end());
  }
  return whole;
}

std::size_t WeightedVoxelMap::voxelCount(const VoxelWeighting& weighting, int threads) const {
  weighting.check();
  std::vector<std::size_t> parts;
  internal::forEachPartOfVoxels(
      entries_, threads, [&parts](std::size_t part_count) { parts.resize(part_count); },
      [&](std::size_t part, const LabelledVoxelSums* first, const LabelledVoxelSums* last) {
        internal::forEachStatistics(first, last, weighting, {}, metresPerStep(origin_),
                                    [&](const std::vector<VoxelStatistics>& batch) { parts[part] += batch.size(); });
      });
  return std::accumulate(parts.begin(), parts.end(), std::size_t{0});
}

std::optional<VoxelStatistics> WeightedVoxelMap::find(const Eigen::Vector3d& position_m,
                                                      const VoxelWeighting& weighting) const {
  weighting.check();
  QuantizedPosition position;
  if (!quantize(position_m, 1.0 / resolution(), position)) return std::nullopt;
  const LabelledVoxelSums least{position.voxel, StructuralLabel::NOISE, {}, 0};
  static_assert(static_cast<int>(StructuralLabel::NOISE) == 0, "the first label of a voxel");
  const auto first = std::lower_bound(entries_.begin(), entries_.end(), least, internal::inMapOrder);
  const auto last = std::find_if(first, entries_.end(),
                                 [&](const LabelledVoxelSums& entry) { return entry.voxel != position.voxel; });
  std::optional<VoxelStatistics> found;
  const LabelledVoxelSums* const begin = entries_.data() + (first - entries_.begin());
  internal::forEachStatistics(begin, begin + (last - first), weighting, {}, metresPerStep(origin_),
                              [&found](const std::vector<VoxelStatistics>& batch) {
                                if (!batch.empty()) found = batch.front();
                              });
  return found;
}

void WeightedVoxelMap::save(const std::string& path) const { internal::writeMapFile(path, origin_, entries_); }

WeightedVoxelMap WeightedVoxelMap::load(const std::string& path) {
  internal::MapFileReader reader(path);
  std::vector<LabelledVoxelSums> entries;
  entries.reserve(reader.entryCount());
  internal::MapPiece piece;
  std::vector<LabelledVoxelSums> part;
  while (reader.readPiece(piece)) {
    for (const internal::MapPart& encoded : piece.parts) {
      reader.decode(encoded, part);
      entries.insert(entries.end(), part.begin(), part.end());
    }
  }
  return {reader.origin(), std::move(entries)};
}

WeightedVoxelMap WeightedVoxelMap::load(const std::string& path, const MapRegion& region, int threads) {
  using Entries = std::vector<LabelledVoxelSums>;
  MapFileReader reader(path);
  RegionTiles tiles(reader, region);
  MapOrigin origin = reader.origin();
  Entries kept;
  forEachTileInBatches<RegionTile, Entries, Entries>(
      threads, [&tiles](RegionTile& tile) { return tiles.next(tile); },
      [&](const RegionTile& tile, Entries& whole, Entries& entries) {
        decodeTileIn(reader, tile.place, region, whole, entries);
      },
      [&kept](const RegionTile&, const Entries& entries) { kept.insert(kept.end(), entries.begin(), entries.end()); });
  origin.point_count = pointCountOf(kept.data(), kept.data() + kept.size());
  return {origin, std::move(kept)};
}

}  // namespace saw_ndt
