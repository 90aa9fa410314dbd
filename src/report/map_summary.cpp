#include "report/map_summary.h"

#include <algorithm>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

namespace saw_ndt {
namespace {

using Json = nlohmann::ordered_json;

template <typename Value>
VoxelFigure figureOf(const NdtLevel& level, Value value) {
  VoxelFigure figure;
  if (level.empty()) return figure;
  figure.min = figure.max = value(level.cells().front());
  for (const NdtCell& cell : level.cells()) {
    figure.mean += value(cell) / static_cast<double>(level.size());
    figure.min = std::min(figure.min, value(cell));
    figure.max = std::max(figure.max, value(cell));
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

Json toJson(const MapSummary& summary) {
  Json json{{"resolution_m", summary.resolution_m},
            {"coarse_resolution_m", summary.coarse_resolution_m},
            {"labelled", summary.labelled},
            {"scans", summary.scans},
            {"points", summary.points},
            {"entries", summary.entries},
            {"voxels", summary.voxels},
            {"coarse_voxels", summary.coarse_voxels},
            {"box_min_m", toJson(summary.box_min_m)},
            {"box_max_m", toJson(summary.box_max_m)}};
  if (summary.labelled) json["label_points"] = withShares({"noise", "ground", "non_ground"}, summary.label_points);
  json["class_voxels"] = withShares({"linear", "planar", "volumetric"}, summary.class_voxels);
  json["mean_confidence"] = toJson(summary.mean_confidence);
  json["weight"] = toJson(summary.weight);
  return json;
}

void writeLine(std::ostringstream& text, const std::string& name, const Json& value) {
  text << std::left << std::setw(30) << name << value.dump() << '\n';
}

}  // namespace

MapSummary summarize(const WeightedVoxelMap& map) {
  MapSummary summary;
  summary.resolution_m = map.resolution();
  summary.coarse_resolution_m =
      map.weighting().coarse_factor > 1 ? map.weighting().coarse_factor * map.resolution() : 0.0;
  summary.labelled = map.labelled();
  summary.scans = map.origin().scan_count;
  summary.points = map.origin().point_count;
  summary.entries = map.entries().size();
  summary.voxels = map.fine().size();
  summary.coarse_voxels = map.coarse().size();
  measureEntries(map, summary);
  for (std::size_t i = 0; i < map.fine().size(); ++i) {
    ++summary.class_voxels[static_cast<std::size_t>(map.fine().voxel(i).structure_class) - 1];
  }
  summary.mean_confidence = figureOf(map.fine(), [](const NdtCell& cell) { return cell.mean_confidence; });
  summary.weight = figureOf(map.fine(), [](const NdtCell& cell) { return cell.weight; });
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
