#include "map/direction_loops.h"

#include "common/polar_angle.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "map/direction_loops.cpp"
#include "common/vector_dispatch.h"

HWY_BEFORE_NAMESPACE();
namespace saw_ndt::internal {
namespace HWY_NAMESPACE {
namespace {

void measure(std::size_t count, const PointArrays& points, const DirectionGrid& grid,
             const DirectionArrays& directions) {
  float* __restrict range_m = directions.range_m;
  float* __restrict horizontal_range_m = directions.horizontal_range_m;
  std::int32_t* __restrict pixel = directions.pixel;
  const float* __restrict x = points.x;
  const float* __restrict y = points.y;
  const float* __restrict z = points.z;
  const float least = grid.least_range_m * grid.least_range_m;
  const float greatest = grid.greatest_range_m * grid.greatest_range_m;
  const float last_column = static_cast<float>(grid.columns - 1), last_row = static_cast<float>(grid.rows - 1);
  const float pixels_per_radian = grid.pixels_per_radian;
  const std::int32_t columns = grid.columns;
  for (std::size_t i = 0; i < count; ++i) {
    const float squared_horizontal = x[i] * x[i] + y[i] * y[i];
    const float squared_range = squared_horizontal + z[i] * z[i];
    // Not a number compares false.
    const bool valid = (squared_range > least) & (squared_range <= greatest);
    const float horizontal = __builtin_sqrtf(valid ? squared_horizontal : 1.0F);
    // From straight up, the angle is that of (z, horizontal) from the z axis, 0 to half a turn.
    const float row = polarAngle(valid ? z[i] : 1.0F, horizontal) * pixels_per_radian;
    const float column = polarAngle(valid ? x[i] : 1.0F, valid ? y[i] : 0.0F) * pixels_per_radian;
    const auto whole_row = static_cast<std::int32_t>(row < last_row ? row : last_row);
    const auto whole_column = static_cast<std::int32_t>(column < last_column ? column : last_column);
    range_m[i] = __builtin_sqrtf(valid ? squared_range : 0.0F);
    horizontal_range_m[i] = horizontal;
    pixel[i] = valid ? whole_row * columns + whole_column : -1;
  }
}

void transform(std::size_t count, const PointArrays& points, const RigidTransform3f& T, float* __restrict x,
               float* __restrict y, float* __restrict z) {
  const float* __restrict px = points.x;
  const float* __restrict py = points.y;
  const float* __restrict pz = points.z;
  for (std::size_t i = 0; i < count; ++i) {
    x[i] = T.row[0][0] * px[i] + T.row[0][1] * py[i] + T.row[0][2] * pz[i] + T.row[0][3];
    y[i] = T.row[1][0] * px[i] + T.row[1][1] * py[i] + T.row[1][2] * pz[i] + T.row[1][3];
    z[i] = T.row[2][0] * px[i] + T.row[2][1] * py[i] + T.row[2][2] * pz[i] + T.row[2][3];
  }
}

HWY_INLINE float lesser(float a, float b) { return b < a ? b : a; }

void leastOfThree(std::int32_t columns, const float* __restrict a, const float* __restrict b, const float* __restrict c,
                  float* __restrict least) {
  for (std::int32_t i = 0; i < columns; ++i) least[i] = lesser(lesser(a[i], b[i]), c[i]);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace saw_ndt::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saw_ndt::internal {

HWY_EXPORT(measure);
HWY_EXPORT(transform);
HWY_EXPORT(leastOfThree);

void measureDirections(std::size_t count, const PointArrays& points, const DirectionGrid& grid,
                       const DirectionArrays& directions) {
  SAW_NDT_DISPATCH(measure)(count, points, grid, directions);
}

void transformPoints(std::size_t count, const PointArrays& points, const RigidTransform3f& T, float* x, float* y,
                     float* z) {
  SAW_NDT_DISPATCH(transform)(count, points, T, x, y, z);
}

void leastAlongRow(std::int32_t columns, std::int32_t step, const float* row, float* least) {
  const std::int32_t inner = columns - 2 * step;
  if (inner > 0) SAW_NDT_DISPATCH(leastOfThree)(inner, row, row + step, row + 2 * step, least + step);
  for (std::int32_t i = 0; i < columns; ++i) {
    if (i == step && inner > 0) i = columns - step;
    const float to_the_left = row[(i + step) % columns], to_the_right = row[(i + columns - step) % columns];
    const float side = to_the_left < to_the_right ? to_the_left : to_the_right;
    least[i] = side < row[i] ? side : row[i];
  }
}

void leastOfRows(std::int32_t columns, const float* above, const float* middle, const float* below, float* least) {
  SAW_NDT_DISPATCH(leastOfThree)(columns, above, middle, below, least);
}

}  // namespace saw_ndt::internal
#endif
