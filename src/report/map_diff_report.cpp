#include "report/map_diff_report.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

#include "report/figure_lines.h"
#include "report/map_axes.h"
#include "report/map_raster.h"

namespace saw_ndt {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kGroupsInText = 20, kGroupsCircled = 100;
constexpr double kSmallReach_px = 8.0, kCircleMargin_px = 6.0;

Json toJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json toJson(const MapDiffSide& side, VoxelChange change) {
  return {{"voxels", side.voxels},          {"compared", side.compared}, {"unchanged", side.unchanged},
          {toString(change), side.changed}, {"moved", side.moved},       {"not_covered", side.not_covered}};
}

Json toJson(const ChangedGroup& group) {
  Json json{{"change", toString(group.change)},
            {"voxels", group.voxels},
            {"least_m", toJson(group.least_m)},
            {"greatest_m", toJson(group.greatest_m)}};
  if (group.change == VoxelChange::MOVED) json["displacement_m"] = toJson(group.displacement_m);
  return json;
}

Json figuresOf(const MapDiff& diff) {
  return {{"resolution_m", diff.resolution_m},
          {"least_points", diff.options.least_points},
          {"least_scans", diff.options.least_scans},
          {"least_share_of_scans", diff.options.least_share_of_scans},
          {"least_displacement_m", diff.options.least_displacement_m},
          {"least_voxels", diff.options.least_voxels},
          {"first", toJson(diff.first, VoxelChange::VANISHED)},
          {"second", toJson(diff.second, VoxelChange::APPEARED)},
          {"gap_m",
           {{"pairs", diff.gap_count},
            {"p5", diff.gap_percentiles_m[0]},
            {"p50", diff.gap_percentiles_m[1]},
            {"p95", diff.gap_percentiles_m[2]}}}};
}

std::string rounded(const Eigen::Vector3d& v, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << v.x() << ' ' << v.y() << ' ' << v.z();
  return text.str();
}

}  // namespace

std::string toText(const MapDiff& diff) {
  std::ostringstream text;
  text << figureLines(figuresOf(diff));
  text << std::left << std::setw(29) << "groups" << ' ' << diff.groups.size() << '\n';
  for (std::size_t i = 0; i < std::min(diff.groups.size(), kGroupsInText); ++i) {
    const ChangedGroup& group = diff.groups[i];
    text << "  " << std::left << std::setw(9) << toString(group.change) << std::right << std::setw(7) << group.voxels
         << " voxels around " << rounded(0.5 * (group.least_m + group.greatest_m), 1) << " m, within "
         << rounded(group.greatest_m - group.least_m, 1) << " m";
    if (group.change == VoxelChange::MOVED) text << ", by " << rounded(group.displacement_m, 3) << " m";
    text << '\n';
  }
  if (diff.groups.size() > kGroupsInText) text << "  and " << diff.groups.size() - kGroupsInText << " smaller ones\n";
  return text.str();
}

std::string toJsonText(const MapDiff& diff) {
  Json json = figuresOf(diff);
  json["groups"] = Json::array();
  for (const ChangedGroup& group : diff.groups) json["groups"].push_back(toJson(group));
  return json.dump(2) + "\n";
}

pcl::PointCloud<ChangedPoint> changedCloud(const MapDiff& diff) {
  pcl::PointCloud<ChangedPoint> cloud;
  cloud.resize(diff.changes.size());
  for (std::size_t i = 0; i < diff.changes.size(); ++i) {
    const ChangedVoxel& changed = diff.changes[i];
    cloud[i].getVector4fMap() = changed.mean_m.cast<float>().homogeneous();
    cloud[i].label = static_cast<std::uint32_t>(changed.label);
    cloud[i].change = static_cast<float>(changed.change);
    cloud[i].map = changed.in_second ? 2.0F : 1.0F;
    cloud[i].displacement = static_cast<float>(changed.displacement_m.norm());
  }
  return cloud;
}

GnuplotPicture mapDiffPicture(const MapDiff& diff, const WeightedVoxelMap& first, const WeightedVoxelMap& second) {
  // Of kinds in one cell of the picture the latest is seen.
  constexpr struct {
    VoxelChange change;
    const char* colour;
  } kKinds[] = {
      {VoxelChange::MOVED, "#0072b2"}, {VoxelChange::VANISHED, "#d55e00"}, {VoxelChange::APPEARED, "#009e73"}};
  constexpr char kGrey[] = "#d4d4d4";

  std::vector<VoxelCoordinate> places;
  for (const WeightedVoxelMap* map : {&first, &second}) {
    for (const LabelledVoxelSums& entry : map->entries()) places.push_back(entry.voxel);
  }
  const MapAxes axes(windowAround(places, diff.resolution_m));
  MapRaster raster(axes, diff.resolution_m);
  for (const VoxelCoordinate& voxel : places) raster.set(voxel, 0.0, 0.0);
  GnuplotPicture picture;
  picture.name = "map_diff";
  picture.many_points = true;
  std::ostringstream draw;
  draw.precision(12);
  std::string palette = std::string("set palette defined (0 '") + kGrey + "'", plots, keys;
  int value = 0;
  for (const auto& kind : kKinds) {
    ++value;
    const std::string name = toString(kind.change), colour = std::string("lc rgb '") + kind.colour + "'";
    for (const ChangedVoxel& changed : diff.changes) {
      if (changed.change == kind.change) raster.set(changed.voxel, value, value);
    }
    palette += ", " + std::to_string(value) + " '" + kind.colour + "'";
    std::vector<std::vector<double>> circles(3);
    std::size_t groups = 0;
    for (const ChangedGroup& group : diff.groups) {
      if (group.change != kind.change) continue;
      ++groups;
      const Eigen::Vector3d centre = 0.5 * (group.least_m + group.greatest_m);
      const double reach_m = (group.greatest_m - centre).head<2>().norm();
      if (reach_m * axes.scale_px() > kSmallReach_px || circles.front().size() == kGroupsCircled) continue;
      circles[0].push_back(centre.x());
      circles[1].push_back(centre.y());
      circles[2].push_back(reach_m + kCircleMargin_px / axes.scale_px());
    }
    keys = ", keyentry with points pt 5 ps 1.3 " + colour + " title '" + name + " (" + std::to_string(groups) + ")'" +
           keys;
    if (circles.front().empty()) continue;
    picture.data += gnuplotData("$" + name, circles);
    plots += ", $" + name + " with circles fillstyle empty border lw 1.3 " + colour + " notitle";
  }
  picture.data += raster.data("$voxels");
  draw << palette << ")\nset cbrange [0:3]\nunset colorbox\nplot " << raster.plot("$voxels") << plots << keys
       << ", keyentry with points pt 5 ps 1.3 lc rgb '" << kGrey << "' title 'in either map'\n";
  picture.commands = draw.str();
  axes.begin(picture, "what has changed, and the voxels of both maps, from above");
  picture.caption = "Changed voxels on those of both maps; circles are around small groups of them.";
  return picture;
}

}  // namespace saw_ndt
