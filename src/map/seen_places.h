#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "map/map_surfaces.h"
#include "map/voxel_index.h"

namespace saw_ndt::internal {

/// Where a map's scans have looked, as far as its surfaces tell. Light that met something at the foot of a column came
/// through the air above it: an object up there would have been met.
class SeenPlaces {
 public:
  explicit SeenPlaces(const MapSurfaces& surfaces);

  /// Whether the map would have a surface of `least_points` in a voxel if it were as it is in another map, where it has
  /// `point_count`. It has to have a surface in the voxel or below it; that is 2 m below at most, or something within
  /// 8 m reaches as high; and in the columns around, up to the voxel, it has so many points in proportion to those of
  /// the other map.
  bool cover(const VoxelCoordinate& voxel, std::uint64_t point_count, const SeenPlaces& other,
             std::uint64_t least_points) const;

  /// The number of scans that met a surface, of the one in the column of a voxel or in those around that most met.
  std::uint32_t mostScansAround(const VoxelCoordinate& voxel) const;

 private:
  struct Column {
    std::size_t first = 0, last = 0;  // in heights_ and points_
    std::uint32_t most_scans = 0;
  };

  const Column* columnAt(int x, int y) const;
  bool reaches(const VoxelCoordinate& voxel) const;
  std::uint64_t pointsUpTo(const VoxelCoordinate& voxel) const;
  VoxelCoordinate areaOf(const VoxelCoordinate& voxel) const;

  std::vector<Column> columns_;
  VoxelIndex column_index_;  // of columns by x and y
  std::vector<int> heights_;
  std::vector<std::uint64_t> points_;  // up to there, of the column
  int sure_height_;                    // above a surface, in voxels
  int area_edge_;                      // in voxels
  std::vector<int> greatest_heights_;  // of square areas
  VoxelIndex area_index_;
};

}  // namespace saw_ndt::internal
