#include "segmentation/range_image_loops.h"

#include <cmath>

#include "common/polar_angle.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "segmentation/range_image_loops.cpp"
#include "common/vector_dispatch.h"

HWY_BEFORE_NAMESPACE();
namespace saw_ndt::internal {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// The hardware follows such a stream to the end of a page alone.
constexpr std::size_t kPointsAhead = 96;
constexpr std::size_t kBlock = PointMeasurements::kBlock;
constexpr std::uint16_t kNoColumn = PointMeasurements::kNoColumn;
constexpr float kGreatestFloat = 3.402823466e+38F;

HWY_INLINE void measureBlock(std::size_t count, const ProjectionGeometry geometry, const float* __restrict x,
                             const float* __restrict y, const float* __restrict z, std::uint16_t* __restrict column,
                             float* __restrict range, float* __restrict horizontal_range, float* __restrict height) {
  const float least_squared_range = geometry.least_range * geometry.least_range;
  const float greatest = geometry.greatest_range * geometry.greatest_range;
  const float greatest_squared_range = greatest <= kGreatestFloat ? greatest : kGreatestFloat;
  for (std::size_t i = 0; i < count; ++i) {
    const float squared_range = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
    // Not a number compares false; an infinite coordinate, or one whose square overflows, gives infinity.
    const bool valid = (squared_range > least_squared_range) & (squared_range <= greatest_squared_range);
    const float safe_squared_range = valid ? squared_range : 0.0F;
    const float place = polarAngle(x[i], y[i]) * geometry.columns_per_radian;
    const float safe_place = valid ? place : 0.0F;
    const float level_height = geometry.up_z * z[i] + geometry.up_x * x[i] + geometry.up_y * y[i];
    const float squared_horizontal_range = safe_squared_range - level_height * level_height;
    const auto whole = static_cast<std::int32_t>(safe_place < geometry.last_column ? safe_place : geometry.last_column);
    column[i] = static_cast<std::uint16_t>(valid ? whole : kNoColumn);
    range[i] = __builtin_sqrtf(safe_squared_range);
    horizontal_range[i] = __builtin_sqrtf(squared_horizontal_range > 0.0F ? squared_horizontal_range : 0.0F);
    height[i] = level_height;
  }
}

// Of columns that are followed by kNoColumn up to a whole block.
HWY_INLINE ColumnSpan spanOf(const std::uint16_t* HWY_RESTRICT column) {
  const hn::CappedTag<std::uint16_t, kBlock> d;
  const auto one = hn::Set(d, std::uint16_t{1});
  auto least = hn::Set(d, kNoColumn);
  auto greatest = hn::Zero(d);  // and one more: kNoColumn then becomes 0
  for (std::size_t i = 0; i < kBlock; i += hn::Lanes(d)) {
    const auto columns = hn::Load(d, column + i);
    least = hn::Min(least, columns);
    greatest = hn::Max(greatest, hn::Add(columns, one));
  }
  HWY_ALIGN std::uint16_t least_of_lanes[kBlock];
  HWY_ALIGN std::uint16_t greatest_of_lanes[kBlock];
  hn::Store(least, d, least_of_lanes);
  hn::Store(greatest, d, greatest_of_lanes);
  ColumnSpan span = {kNoColumn, 0};
  for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
    span.least = least_of_lanes[lane] < span.least ? least_of_lanes[lane] : span.least;
    span.greatest = greatest_of_lanes[lane] > span.greatest ? greatest_of_lanes[lane] : span.greatest;
  }
  if (span.greatest > 0) --span.greatest;
  return span;
}

void measure(std::size_t count, std::size_t stride, const float* xyz, const ProjectionGeometry& geometry,
             const MeasuredArrays& measured) {
  HWY_ALIGN float x[kBlock];
  HWY_ALIGN float y[kBlock];
  HWY_ALIGN float z[kBlock];
  HWY_ALIGN std::uint16_t column[kBlock];
  for (std::size_t begin = 0; begin < count; begin += kBlock) {
    const std::size_t size = count - begin < kBlock ? count - begin : kBlock;
    const float* point = xyz + begin * stride;
    for (std::size_t i = 0; i < size; ++i, point += stride) {
      __builtin_prefetch(point + kPointsAhead * stride);
      x[i] = point[0];
      y[i] = point[1];
      z[i] = point[2];
    }
    measureBlock(size, geometry, x, y, z, column, measured.range + begin, measured.horizontal_range + begin,
                 measured.height + begin);
    for (std::size_t i = 0; i < size; ++i) measured.column[begin + i] = column[i];
    for (std::size_t i = size; i < kBlock; ++i) column[i] = kNoColumn;
    measured.spans[begin / kBlock] = spanOf(column);
  }
}

void addFirstPixel(std::size_t count, const std::uint16_t* __restrict column, std::int32_t first_pixel,
                   std::int32_t* __restrict pixel) {
  for (std::size_t i = 0; i < count; ++i) {
    pixel[i] = column[i] == kNoColumn ? -1 : first_pixel + column[i];
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace saw_ndt::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saw_ndt::internal {

HWY_EXPORT(measure);
HWY_EXPORT(addFirstPixel);

void measurePoints(std::size_t count, std::size_t stride, const float* xyz, const ProjectionGeometry& geometry,
                   const MeasuredArrays& measured) {
  SAW_NDT_DISPATCH(measure)(count, stride, xyz, geometry, measured);
}

void pixelsOfColumns(std::size_t count, const std::uint16_t* column, std::int32_t first_pixel, std::int32_t* pixel) {
  SAW_NDT_DISPATCH(addFirstPixel)(count, column, first_pixel, pixel);
}

}  // namespace saw_ndt::internal
#endif
