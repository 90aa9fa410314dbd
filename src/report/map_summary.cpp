#include "report/map_summary.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/middle_value.h"
#include "map/map_tile.h"
#include "report/figure_lines.h"
#include "report/map_figures.h"
#include "saw_ndt/map/ndt_target.h"

namespace saw_ndt {

using namespace internal;

namespace {

using Json = nlohmann::ordered_json;

template <typename Value>
VoxelFigure figureOf(const std::vector<VoxelStatistics>& voxels, Value value) {
  VoxelFigure figure;
  if (voxels.empty()) return figure;
  figure.min = figure.max = value(voxels.front());
  for (const VoxelStatistics& voxel : voxels) {
    figure.mean += value(voxel) / static_cast<double>(voxels.size());
    figure.min = std::min(figure.min, value(voxel));
    figure.max = std::max(figure.max, value(voxel));
  }
  return figure;
}

// How many columns of voxels hold points.
std::size_t columnCount(const std::vector<LabelledVoxelSums>& entries) {
  std::vector<std::pair<int, int>> columns;
  for (const LabelledVoxelSums& entry : entries) {
    const std::pair column(entry.voxel.x(), entry.voxel.y());
    if (columns.empty() || columns.back() != column) columns.push_back(column);
  }
  std::sort(columns.begin(), columns.end());
  return static_cast<std::size_t>(std::unique(columns.begin(), columns.end()) - columns.begin());
}

// Of entries in map order, one or more.
void measureTiles(const std::vector<LabelledVoxelSums>& entries, MapSummary& summary) {
  std::vector<std::size_t> sizes;
  Eigen::Vector3i before = tileOf(entries.front().voxel);
  sizes.push_back(0);
  for (const LabelledVoxelSums& entry : entries) {
    const Eigen::Vector3i tile = tileOf(entry.voxel);
    if (tile != before) sizes.push_back(0);
    before = tile;
    ++sizes.back();
  }
  summary.tiles = sizes.size();
  const auto [least, greatest] = std::minmax_element(sizes.begin(), sizes.end());
  summary.tile_entries.min = *least;
  summary.tile_entries.max = *greatest;
  summary.tile_entries.median = middleValue(sizes);
}

void measureEntries(const WeightedVoxelMap& map, MapSummary& summary) {
  if (map.entries().empty()) return;
  VoxelCoordinate lowest = map.entries().front().voxel, highest = lowest;
  for (const LabelledVoxelSums& entry : map.entries()) {
    lowest = lowest.cwiseMin(entry.voxel);
    highest = highest.cwiseMax(entry.voxel);
    summary.label_points[static_cast<std::size_t>(entry.label)] += entry.sums.count;
  }
  measureTiles(map.entries(), summary);
  summary.area_m2 = static_cast<double>(columnCount(map.entries())) * map.resolution() * map.resolution();
  summary.box_min_m = lowest.cast<double>() * map.resolution();
  summary.box_max_m = (highest.cast<double>().array() + 1.0).matrix() * map.resolution();
}

Json toJson(const VoxelFigure& figure) { return {{"mean", figure.mean}, {"min", figure.min}, {"max", figure.max}}; }

Json bytesOf(std::uint64_t file_bytes, const MapSummary& summary) {
  const auto each = [file_bytes](std::size_t count) {
    return count == 0 ? 0.0 : static_cast<double>(file_bytes) / static_cast<double>(count);
  };
  return {{"file", file_bytes}, {"per_entry", each(summary.entries)}, {"per_voxel", each(summary.voxels)}};
}

Json toJson(const MapSummary& summary) {
  Json json{{"resolution_m", summary.resolution_m},
            {"coarse_resolution_m", summary.coarse_resolution_m},
            {"labelled", summary.labelled},
            {"software_version", orNotKnown(summary.software_version)},
            {"scans", summary.scans},
            {"points", summary.points},
            {"entries", summary.entries},
            {"voxels", summary.voxels},
            {"coarse_voxels", summary.coarse_voxels},
            {"box_min_m", vectorFigures(summary.box_min_m)},
            {"box_max_m", vectorFigures(summary.box_max_m)},
            {"extent_m", vectorFigures(summary.box_max_m - summary.box_min_m)},
            {"area_m2", summary.area_m2},
            {"tiles", summary.tiles},
            {"tile_entries", toJson(summary.tile_entries)}};
  if (summary.file_bytes) json["bytes"] = bytesOf(*summary.file_bytes, summary);
  if (!summary.map_origin_m.isZero(0.0)) json["map_origin_m"] = vectorFigures(summary.map_origin_m);
  if (summary.dead_bytes != 0) json["dead_bytes"] = summary.dead_bytes;
  if (summary.labelled) json["label_points"] = withShares({"noise", "ground", "non_ground"}, summary.label_points);
  json["class_voxels"] = classFigures(summary.class_voxels);
  if (summary.labelled) json["segmentation"] = segmentationFigures(summary.segmentation);
  json["mean_confidence"] = toJson(summary.mean_confidence);
  json["weight"] = toJson(summary.weight);
  return json;
}

}  // namespace

MapSummary summarize(const WeightedVoxelMap& map, const VoxelWeighting& weighting) {
  MapSummary summary;
  summary.resolution_m = map.resolution();
  summary.coarse_resolution_m = weighting.coarse_factor > 1 ? weighting.coarse_factor * map.resolution() : 0.0;
  summary.labelled = map.labelled();
  summary.map_origin_m = map.origin().map_origin_m;
  summary.software_version = map.origin().software_version;
  summary.segmentation = map.origin().segmentation;
  summary.scans = map.origin().scan_count;
  summary.points = map.origin().point_count;
  summary.entries = map.entries().size();
  summary.coarse_voxels = NdtTarget(map, weighting).coarseVoxelCount();
  measureEntries(map, summary);
  const std::vector<VoxelStatistics> voxels = map.statistics(weighting);
  summary.voxels = voxels.size();
  for (const VoxelStatistics& voxel : voxels) {
    ++summary.class_voxels[static_cast<std::size_t>(voxel.structure_class) - 1];
  }
  summary.mean_confidence = figureOf(voxels, [](const VoxelStatistics& voxel) { return voxel.mean_confidence; });
  summary.weight = figureOf(voxels, [](const VoxelStatistics& voxel) { return voxel.weight; });
  return summary;
}

std::string toText(const MapSummary& summary) { return figureLines(toJson(summary)); }

std::string toJsonText(const MapSummary& summary) { return toJson(summary).dump(2) + "\n"; }

}  // namespace saw_ndt
