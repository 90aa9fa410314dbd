#include "report/map_picture.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "report/map_axes.h"
#include "report/method_colour.h"
#include "saw_ndt/common/labels.h"

namespace saw_ndt {
namespace {

constexpr double kMargin_m = 30.0;  // of the map shown around the drive
constexpr double kMarkDistance_px = 12.0;
constexpr double kLineStep_px = 1.7;   // between the widths of lines that may lie on each other
constexpr double kPointSize_px = 7.0;  // of gnuplot's point size 1

MapWindow windowAround(const BenchmarkRun& run) {
  const Eigen::Vector3d first = run.T_map_base.front().translation();
  MapWindow window{first.x(), first.x(), first.y(), first.y()};
  for (const Eigen::Isometry3d& T : run.T_map_base) {
    window.x_min = std::min(window.x_min, T.translation().x());
    window.x_max = std::max(window.x_max, T.translation().x());
    window.y_min = std::min(window.y_min, T.translation().y());
    window.y_max = std::max(window.y_max, T.translation().y());
  }
  return {window.x_min - kMargin_m, window.x_max + kMargin_m, window.y_min - kMargin_m, window.y_max + kMargin_m};
}

using Columns = std::vector<std::vector<double>>;

Columns voxelsOf(const BenchmarkRun& run, const MapWindow& window, bool ground) {
  Columns columns(2);
  for (const VoxelPoint& voxel : run.voxels) {
    if ((voxel.label == static_cast<std::uint32_t>(StructuralLabel::GROUND)) != ground) continue;
    if (!window.contains(voxel.x, voxel.y)) continue;
    columns[0].push_back(voxel.x);
    columns[1].push_back(voxel.y);
  }
  return columns;
}

template <typename PositionOf>
Columns positions(std::size_t count, PositionOf position_of) {
  Columns columns(2);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d position = position_of(i);
    columns[0].push_back(position.x());
    columns[1].push_back(position.y());
  }
  return columns;
}

/// The poses at which the scans of any method were rejected, but for those too close to the one before to be told from
/// it.
Columns rejectedPositions(const BenchmarkRun& run, double least_distance_m) {
  Columns columns(2);
  for (const BenchmarkCell& cell : run.cells) {
    const LocalizationResult* shown = nullptr;
    for (const LocalizationResult& result : cell.run.results) {
      if (result.accepted()) continue;
      const Eigen::Vector3d position = result.T_map_base.translation();
      if (shown != nullptr && (position - shown->T_map_base.translation()).norm() < least_distance_m) continue;
      columns[0].push_back(position.x());
      columns[1].push_back(position.y());
      shown = &result;
    }
  }
  return columns;
}

/// A block needs a line for gnuplot to plot it; NaN draws none.
Columns orNothing(Columns columns) {
  for (std::vector<double>& column : columns) {
    if (column.empty()) column.push_back(std::nan(""));
  }
  return columns;
}

}  // namespace

GnuplotPicture mapPicture(const BenchmarkRun& run) {
  const MapAxes axes(windowAround(run));
  const MapWindow& window = axes.window();
  const double scale_px = axes.scale_px();
  GnuplotPicture picture;
  picture.name = "map";
  picture.many_points = true;
  picture.data = gnuplotData("$ground", orNothing(voxelsOf(run, window, true))) +
                 gnuplotData("$structure", orNothing(voxelsOf(run, window, false))) +
                 gnuplotData("$rejected", orNothing(rejectedPositions(run, kMarkDistance_px / scale_px))) +
                 gnuplotData("$reference", positions(run.T_map_base.size(),
                                                     [&](std::size_t i) { return run.T_map_base[i].translation(); }));
  std::ostringstream draw;
  draw << "set label 1 'start' at " << run.T_map_base.front().translation().x() << ','
       << run.T_map_base.front().translation().y() << " offset 0.6,-1.1 front\n";
  const double point_size = std::clamp(0.7 * scale_px / kPointSize_px, 0.12, 0.8);
  draw << "plot $ground with points pt 7 ps " << point_size << " lc rgb '#e6d9b8' notitle, "
       << "$structure with points pt 7 ps " << point_size << " lc rgb '#a9b2bd' notitle, "
       << "NaN with points pt 7 ps 1 lc rgb '#e6d9b8' title 'ground', "
       << "NaN with points pt 7 ps 1 lc rgb '#a9b2bd' title 'not ground', ";
  // Methods that agree lie on each other: each line is thinner than the one below it, so that all can be seen.
  double line_width = kLineStep_px * static_cast<double>(run.cells.size() + 1);
  draw << "$reference with lines lw " << line_width << " lc rgb '#000000' title 'reference', ";
  for (std::size_t m = 0; m < run.cells.size(); ++m) {
    const std::vector<LocalizationResult>& results = run.cells[m].run.results;
    const std::string block = "$method" + std::to_string(m);
    picture.data += gnuplotData(
        block, positions(results.size(), [&](std::size_t i) { return results[i].T_map_base.translation(); }));
    line_width -= kLineStep_px;
    draw << block << " with lines lw " << line_width << " lc rgb '" << methodColour(run.cells[m].method) << "' title "
         << gnuplotQuoted(run.cells[m].method) << ", ";
  }
  draw << "$reference every ::0::0 with points pt 7 ps 1.4 lc rgb '#000000' notitle, "
       << "$rejected with points pt 2 ps 1.3 lw 1.5 lc rgb '#000000' title 'rejected scan'\n";
  picture.commands = draw.str();
  axes.begin(picture, run.sequence + ", " + toString(run.drive) + ": the map from above and the trajectories");
  picture.caption =
      "The map (the mean of each voxel, from above) with the reference and what each method said. Lines that agree "
      "lie on each other, the reference widest. Crosses are scans that a method rejected (one of many where they are "
      "dense); there it shows the pose "
      "it had predicted.";
  return picture;
}

}  // namespace saw_ndt
