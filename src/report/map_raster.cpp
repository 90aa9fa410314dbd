#include "report/map_raster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "common/floor_division.h"
#include "report/gnuplot.h"

namespace saw_ndt {
namespace {

constexpr double kMargin = 0.03;  // of the window, of the greater of its lengths

}  // namespace

MapRaster::MapRaster(const MapAxes& axes, double resolution_m) {
  const double element_m = 1.0 / (axes.scale_px() * kPngScale);
  voxels_per_cell_ = std::max(1, static_cast<int>(std::ceil(element_m / resolution_m)));
  cell_m_ = voxels_per_cell_ * resolution_m;
  const MapWindow& window = axes.window();
  first_x_ = static_cast<int>(std::floor(window.x_min / cell_m_));
  first_y_ = static_cast<int>(std::floor(window.y_min / cell_m_));
  columns_ = static_cast<std::size_t>(std::ceil(window.x_max / cell_m_) - first_x_);
  rows_ = static_cast<std::size_t>(std::ceil(window.y_max / cell_m_) - first_y_);
  cells_.assign(columns_ * rows_, {-std::numeric_limits<double>::infinity(), std::nan("")});
}

void MapRaster::set(const VoxelCoordinate& voxel, double height, double value) {
  const int x = internal::floorDivided(voxel.x(), voxels_per_cell_) - first_x_;
  const int y = internal::floorDivided(voxel.y(), voxels_per_cell_) - first_y_;
  if (x < 0 || y < 0 || static_cast<std::size_t>(x) >= columns_ || static_cast<std::size_t>(y) >= rows_) return;
  Cell& cell = cells_[static_cast<std::size_t>(y) * columns_ + static_cast<std::size_t>(x)];
  if (height >= cell.height) cell = {height, value};
}

std::string MapRaster::data(const std::string& name) const {
  std::ostringstream text;
  text << name << " << END_OF_DATA\n";
  for (std::size_t y = 0; y < rows_; ++y) {
    for (std::size_t x = 0; x < columns_; ++x) {
      const double value = cells_[y * columns_ + x].value;
      if (std::isnan(value)) {
        text << "NaN ";
      } else {
        text << value << ' ';
      }
    }
    text << '\n';
  }
  text << "END_OF_DATA\n";
  return text.str();
}

std::string MapRaster::plot(const std::string& name) const {
  std::ostringstream text;
  text.precision(12);
  text << name << " matrix using (" << (first_x_ + 0.5) * cell_m_ << " + " << cell_m_ << " * $1):("
       << (first_y_ + 0.5) * cell_m_ << " + " << cell_m_ << " * $2):3 with image notitle";
  return text.str();
}

MapWindow windowAround(const std::vector<VoxelCoordinate>& voxels, double resolution_m) {
  if (voxels.empty()) return {-1.0, 1.0, -1.0, 1.0};
  VoxelCoordinate least = voxels.front(), greatest = voxels.front();
  for (const VoxelCoordinate& voxel : voxels) {
    least = least.cwiseMin(voxel);
    greatest = greatest.cwiseMax(voxel);
  }
  const Eigen::Vector3d low = least.cast<double>() * resolution_m;
  const Eigen::Vector3d high = (greatest.cast<double>().array() + 1.0).matrix() * resolution_m;
  const double margin = kMargin * (high - low).head<2>().maxCoeff();
  return {low.x() - margin, high.x() + margin, low.y() - margin, high.y() + margin};
}

}  // namespace saw_ndt
