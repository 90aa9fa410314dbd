#pragma once

#include <cstddef>
#include <cstdint>

#include "segmentation/point_measurements.h"

namespace saw_ndt::internal {

/// How points become columns and heights.
struct ProjectionGeometry {
  float columns_per_radian;
  float last_column;
  float up_x, up_y, up_z;  ///< the vertical, in the frame of the points
  float least_range, greatest_range;
};

/// Where measurePoints() writes, each array beginning with the first of the points.
struct MeasuredArrays {
  std::uint16_t* column;
  float* range;
  float* horizontal_range;
  float* height;
  ColumnSpan* spans;  ///< one for every PointMeasurements::kBlock points
};

/// Measures `count` points that are `stride` floats apart. The same bits for every instruction set.
void measurePoints(std::size_t count, std::size_t stride, const float* xyz, const ProjectionGeometry& geometry,
                   const MeasuredArrays& measured);

/// Writes pixel = first_pixel + column, or RangeImage::kNoPixel where there is no column.
void pixelsOfColumns(std::size_t count, const std::uint16_t* column, std::int32_t first_pixel, std::int32_t* pixel);

}  // namespace saw_ndt::internal
