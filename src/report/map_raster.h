#pragma once

#include <string>
#include <vector>

#include "report/map_axes.h"
#include "saw_ndt/map/voxel_sums.h"

namespace saw_ndt {

/// Voxels seen from above as an image of square cells, each with the value of the topmost voxel that lies in it. A cell
/// is a voxel wide, or so many as one element of the picture shows.
class MapRaster {
 public:
  MapRaster(const MapAxes& axes, double resolution_m);

  /// @param height  of voxels to be told from others in the same cell by it: the greatest one stays, of equal ones the
  /// latest
  void set(const VoxelCoordinate& voxel, double height, double value);

  /// Edge of a cell (m).
  double cell_m() const { return cell_m_; }
  /// A data block of gnuplot; NaN where nothing has been set.
  std::string data(const std::string& name) const;
  /// What plots such a block: "$name matrix using ... with image notitle".
  std::string plot(const std::string& name) const;

 private:
  struct Cell {
    double height, value;
  };

  int voxels_per_cell_;
  double cell_m_;
  int first_x_, first_y_;  // coordinates of the first cell
  std::size_t columns_, rows_;
  std::vector<Cell> cells_;
};

/// The window around voxels, with a margin; 1 m around the origin where there is none.
MapWindow windowAround(const std::vector<VoxelCoordinate>& voxels, double resolution_m);

}  // namespace saw_ndt
