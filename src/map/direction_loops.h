#pragma once

#include <cstddef>
#include <cstdint>

namespace saw_ndt::internal {

/// How directions become pixels of a DirectionImage: even steps of the azimuth from the x axis and of the elevation
/// from straight up.
struct DirectionGrid {
  std::int32_t columns, rows;
  float pixels_per_radian;
  float least_range_m, greatest_range_m;  ///< of the points that count
};

/// Where points are, in the frame of the image (m), each in arrays of its own.
struct PointArrays {
  const float* x;
  const float* y;
  const float* z;
};

/// Where measureDirections() writes.
struct DirectionArrays {
  float* range_m;
  float* horizontal_range_m;  ///< from the z axis
  std::int32_t* pixel;        ///< row * columns + column, or -1 where a point is not finite or out of range
};

/// Measures `count` points. The same bits for every instruction set.
void measureDirections(std::size_t count, const PointArrays& points, const DirectionGrid& grid,
                       const DirectionArrays& directions);

/// What turns points and moves them: rows of R, and t behind each.
struct RigidTransform3f {
  float row[3][4];
};

/// Writes R p + t of `count` points. The same bits for every instruction set.
void transformPoints(std::size_t count, const PointArrays& points, const RigidTransform3f& transform, float* x,
                     float* y, float* z);

/// Of each pixel the least of itself and of those `step` columns to either side, which go round.
void leastAlongRow(std::int32_t columns, std::int32_t step, const float* row, float* least);

/// The least of three rows, pixel by pixel.
void leastOfRows(std::int32_t columns, const float* above, const float* middle, const float* below, float* least);

}  // namespace saw_ndt::internal
