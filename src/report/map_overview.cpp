#include "report/map_overview.h"

#include <algorithm>
#include <iterator>
#include <sstream>

#include "evaluation/statistics.h"
#include "report/map_axes.h"
#include "report/map_raster.h"
#include "report/voxel_cloud.h"

namespace saw_ndt {

using namespace internal;

namespace {

/// A value with a name and a colour of its own.
struct NamedColour {
  const char* name;
  const char* colour;
};
constexpr NamedColour kLabels[] = {{"noise", "#b07aa1"}, {"ground", "#d8c48f"}, {"not ground", "#35608d"}};
constexpr NamedColour kClasses[] = {{"linear", "#e69f00"}, {"planar", "#4c92c3"}, {"volumetric", "#2f8f5b"}};

double valueOf(const OverviewVoxel& voxel, OverviewColour colour) {
  switch (colour) {
    case OverviewColour::LABEL:
      return static_cast<double>(voxel.label);
    case OverviewColour::CLASS:
      return static_cast<double>(voxel.structure_class) - 1.0;
    case OverviewColour::WEIGHT:
      return voxel.weight;
    case OverviewColour::HEIGHT:
      break;
  }
  return voxel.height_m;
}

/// The palette and the legend of three values, 0 to 2.
void drawNamed(const NamedColour (&names)[3], std::ostringstream& draw, std::string& keys) {
  draw << "set palette defined (";
  for (int i = 0; i < 3; ++i) draw << (i == 0 ? "" : ", ") << i << " '" << names[i].colour << "'";
  draw << ")\nset cbrange [0:2]\nunset colorbox\n";
  for (const NamedColour& named : names) {
    keys += std::string(", keyentry with points pt 5 ps 1.3 lc rgb '") + named.colour + "' title '" + named.name + "'";
  }
}

/// The palette of a figure, from its 1st to its 99th percentile, beyond which colours do not change.
void drawScale(const std::vector<OverviewVoxel>& voxels, OverviewColour colour, std::ostringstream& draw) {
  std::vector<double> values;
  std::transform(voxels.begin(), voxels.end(), std::back_inserter(values),
                 [colour](const OverviewVoxel& voxel) { return valueOf(voxel, colour); });
  const double low = values.empty() ? 0.0 : percentile(values, 1.0);
  const double high = values.empty() ? 1.0 : percentile(values, 99.0);
  draw << "set palette defined (0 '#440154', 1 '#3b528b', 2 '#21918c', 3 '#5ec962', 4 '#fde725')\nset cbrange [" << low
       << ':' << std::max(high, low + 1e-6)
       << "]\nset colorbox user origin graph 1.03,graph 0 size 0.02,graph 1\nset format cb '%.4g'\nset cblabel '"
       << (colour == OverviewColour::WEIGHT ? "weight" : "z of the topmost voxel (m)") << "' offset 1.5,0\n";
}

}  // namespace

std::string toString(OverviewColour colour) {
  switch (colour) {
    case OverviewColour::LABEL:
      return "label";
    case OverviewColour::CLASS:
      return "class";
    case OverviewColour::WEIGHT:
      return "weight";
    case OverviewColour::HEIGHT:
      break;
  }
  return "height";
}

std::vector<OverviewVoxel> overviewVoxels(const WeightedVoxelMap& map) {
  const VoxelWeighting weighting;
  const std::vector<VoxelStatistics> statistics = map.statistics(weighting);
  const std::vector<StructuralLabel> labels = voxelLabels(map, statistics, weighting.confidence);
  std::vector<OverviewVoxel> voxels(statistics.size());
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    voxels[i] = {statistics[i].voxel, statistics[i].mean(map.resolution()).z(), labels[i],
                 statistics[i].structure_class, statistics[i].weight};
  }
  return voxels;
}

GnuplotPicture overviewPicture(const std::vector<OverviewVoxel>& voxels, double resolution_m, OverviewColour colour,
                               const std::string& title) {
  std::vector<VoxelCoordinate> places;
  std::transform(voxels.begin(), voxels.end(), std::back_inserter(places),
                 [](const OverviewVoxel& voxel) { return voxel.voxel; });
  const MapAxes axes(windowAround(places, resolution_m));
  MapRaster raster(axes, resolution_m);
  for (const OverviewVoxel& voxel : voxels) raster.set(voxel.voxel, voxel.height_m, valueOf(voxel, colour));
  GnuplotPicture picture;
  picture.name = "map";
  picture.many_points = true;
  picture.data = raster.data("$voxels");
  std::ostringstream draw;
  draw.precision(9);
  std::string keys;
  if (colour == OverviewColour::LABEL) {
    drawNamed(kLabels, draw, keys);
  } else if (colour == OverviewColour::CLASS) {
    drawNamed(kClasses, draw, keys);
  } else {
    drawScale(voxels, colour, draw);
  }
  draw << "plot " << raster.plot("$voxels") << keys << '\n';
  picture.commands = draw.str();
  axes.begin(picture, title);
  picture.caption = "The map from above: the topmost voxel at every place.";
  return picture;
}

}  // namespace saw_ndt
