#include "report/map_summary.h"

#include <algorithm>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>
#include <type_traits>

#include "saw_ndt/map/ndt_target.h"
#include "segmentation/segmentation_fields.h"

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

void measureEntries(const WeightedVoxelMap& map, MapSummary& summary) {
  if (map.entries().empty()) return;
  VoxelCoordinate lowest = map.entries().front().voxel, highest = lowest;
  for (const LabelledVoxelSums& entry : map.entries()) {
    lowest = lowest.cwiseMin(entry.voxel);
    highest = highest.cwiseMax(entry.voxel);
    summary.label_points[static_cast<std::size_t>(entry.label)] += entry.sums.count;
  }
  summary.box_min_m = lowest.cast<double>() * map.resolution();
  summary.box_max_m = (highest.cast<double>().array() + 1.0).matrix() * map.resolution();
}

Json toJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json toJson(const VoxelFigure& figure) { return {{"mean", figure.mean}, {"min", figure.min}, {"max", figure.max}}; }

// {"<name>": count, ..., "<name>_share": ...}
template <typename Count>
Json withShares(const std::array<const char*, 3>& names, const std::array<Count, 3>& counts) {
  Json counted, shares;
  double total = 0.0;
  for (const Count count : counts) total += static_cast<double>(count);
  for (std::size_t i = 0; i < names.size(); ++i) {
    counted[names[i]] = counts[i];
    shares[std::string(names[i]) + "_share"] = total > 0.0 ? static_cast<double>(counts[i]) / total : 0.0;
  }
  counted.update(shares);
  return counted;
}

constexpr char kNotKnown[] = "not known";

// {"sensor.name": ..., "sensor.columns": ..., ...}
Json toJson(const SegmentationOptions& options) {
  Json json;
  internal::forEachField(options, [&json](const char* name, const auto& value) {
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, GroundRule>) {
      json[name] = toString(value);
    } else {
      json[name] = value;
    }
  });
  return json;
}

Json toJson(const MapSummary& summary) {
  Json json{{"resolution_m", summary.resolution_m},
            {"coarse_resolution_m", summary.coarse_resolution_m},
            {"labelled", summary.labelled},
            {"software_version", summary.software_version.empty() ? kNotKnown : summary.software_version},
            {"scans", summary.scans},
            {"points", summary.points},
            {"entries", summary.entries},
            {"voxels", summary.voxels},
            {"coarse_voxels", summary.coarse_voxels},
            {"box_min_m", toJson(summary.box_min_m)},
            {"box_max_m", toJson(summary.box_max_m)}};
  if (!summary.map_origin_m.isZero(0.0)) json["map_origin_m"] = toJson(summary.map_origin_m);
  if (summary.dead_bytes != 0) json["dead_bytes"] = summary.dead_bytes;
  if (summary.labelled) json["label_points"] = withShares({"noise", "ground", "non_ground"}, summary.label_points);
  json["class_voxels"] = withShares({"linear", "planar", "volumetric"}, summary.class_voxels);
  if (summary.labelled) json["segmentation"] = summary.segmentation ? toJson(*summary.segmentation) : Json(kNotKnown);
  json["mean_confidence"] = toJson(summary.mean_confidence);
  json["weight"] = toJson(summary.weight);
  return json;
}

void writeLine(std::ostringstream& text, const std::string& name, const Json& value) {
  text << std::left << std::setw(29) << name << ' ' << value.dump() << '\n';
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

std::string toText(const MapSummary& summary) {
  std::ostringstream text;
  const Json json = toJson(summary);
  for (const auto& [name, value] : json.items()) {
    if (!value.is_object()) {
      writeLine(text, name, value);
      continue;
    }
    for (const auto& [part, part_value] : value.items()) writeLine(text, name + "." + part, part_value);
  }
  return text.str();
}

std::string toJsonText(const MapSummary& summary) { return toJson(summary).dump(2) + "\n"; }

}  // namespace saw_ndt
