#include "report/localization_map_summary.h"

#include <algorithm>

#include "common/middle_value.h"
#include "map/localization_map_file.h"
#include "report/figure_lines.h"
#include "report/map_figures.h"
#include "saw_ndt/localization/localization_method.h"

namespace saw_ndt {

using namespace internal;

namespace {

using Json = nlohmann::ordered_json;

Json toJson(const LocalizationMapSummary& summary) {
  std::size_t voxels = 0;
  for (const std::size_t count : summary.level_voxels) voxels += count;
  const std::size_t all_voxels = voxels + summary.coarse_voxels;
  Json json{{"kind", "localization map"},
            {"methods", summary.methods},
            {"resolutions_m", summary.resolutions_m},
            {"coarse_resolution_m", summary.coarse_resolution_m},
            {"labelled", summary.origin.labelled},
            {"software_version", orNotKnown(summary.origin.software_version)},
            {"scans", summary.origin.scan_count},
            {"points", summary.origin.point_count},
            {"voxels", voxels},
            {"level_voxels", summary.level_voxels},
            {"coarse_voxels", summary.coarse_voxels},
            {"box_min_m", {summary.box_min_m.x(), summary.box_min_m.y()}},
            {"box_max_m", {summary.box_max_m.x(), summary.box_max_m.y()}},
            {"tile_m", summary.tile_m},
            {"tiles", summary.tiles},
            {"tile_bytes", toJson(summary.tile_bytes)},
            {"bytes",
             {{"file", summary.file_bytes},
              {"search", summary.search_bytes},
              {"per_voxel",
               all_voxels == 0 ? 0.0 : static_cast<double>(summary.file_bytes) / static_cast<double>(all_voxels)}}},
            {"class_voxels", classFigures(summary.class_voxels)}};
  if (!summary.origin.map_origin_m.isZero(0.0)) json["map_origin_m"] = vectorFigures(summary.origin.map_origin_m);
  if (summary.origin.labelled) json["segmentation"] = segmentationFigures(summary.origin.segmentation);
  return json;
}

}  // namespace

LocalizationMapSummary summarize(const LocalizationMap& map) {
  const LocalizationMapFile& file = map.file();
  LocalizationMapSummary summary;
  summary.origin = map.origin();
  for (const std::string& name : LocalizationMethod::names()) {
    if (LocalizationMethod::named(name).voxels == map.weighting()) summary.methods.push_back(name);
  }
  summary.resolutions_m = file.resolutions();
  if (map.weighting().coarse_factor > 1) {
    summary.coarse_resolution_m = summary.resolutions_m.back();
    summary.resolutions_m.pop_back();
  }
  const std::size_t level_count = summary.resolutions_m.size();
  summary.level_voxels.resize(level_count);
  summary.box_min_m = file.least();
  summary.box_max_m = file.greatest();
  summary.tile_m = kLocalizationTile_m;
  summary.tiles = file.tileCount();
  summary.file_bytes = map.fileSize();
  std::vector<std::size_t> tile_bytes;
  for (const LocalizationTilePlace& place : file.allTiles()) {
    tile_bytes.push_back(std::size_t{place.cell_bytes} + place.table_bytes);
    summary.search_bytes += place.table_bytes;
    file.forEachCellOf(place, [&](std::size_t level, const QuantizedCell& cell) {
      if (level == level_count) {
        ++summary.coarse_voxels;
        return;
      }
      ++summary.level_voxels[level];
      ++summary.class_voxels[static_cast<std::size_t>(cell.structure_class) - 1U];
    });
  }
  if (tile_bytes.empty()) return summary;
  const auto [least, greatest] = std::minmax_element(tile_bytes.begin(), tile_bytes.end());
  summary.tile_bytes.min = *least;
  summary.tile_bytes.max = *greatest;
  summary.tile_bytes.median = middleValue(tile_bytes);
  return summary;
}

std::string toText(const LocalizationMapSummary& summary) { return figureLines(toJson(summary)); }
std::string toJsonText(const LocalizationMapSummary& summary) { return toJson(summary).dump(2) + "\n"; }

}  // namespace saw_ndt
