#include "saw_ndt/segmentation/range_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "saw_ndt/common/geometry.h"
#include "segmentation/vector_code.h"

namespace saw_ndt {
namespace {

constexpr std::size_t kBlock = 256;
constexpr auto kTurn = static_cast<float>(2.0 * kPi);

// The angle of (x, y) from the x axis, 0 to 2 pi, to 2e-6 rad and without a branch, so that the compiler makes vector
// code of a loop over it. Minimax polynomial of the arc tangent on [0, 1] (Abramowitz and Stegun 4.4.49).
inline float azimuthOf(float x, float y) {
  const float absolute_x = std::abs(x);
  const float absolute_y = std::abs(y);
  const float greater = std::max(absolute_x, absolute_y);
  const float smaller = std::min(absolute_x, absolute_y);
  const float t = smaller / std::max(greater, std::numeric_limits<float>::min());
  const float s = t * t;
  const float polynomial =
      1.0F +
      s * (-0.3333314528F +
           s * (0.1999355085F +
                s * (-0.1420889944F +
                     s * (0.1065626393F +
                          s * (-0.0752896400F + s * (0.0429096138F + s * (-0.0161657367F + s * 0.0028662257F)))))));
  float angle = t * polynomial;
  angle = absolute_y > absolute_x ? static_cast<float>(kPi / 2) - angle : angle;
  angle = x < 0.0F ? static_cast<float>(kPi) - angle : angle;
  return y < 0.0F ? kTurn - angle : angle;
}

struct BlockGeometry {
  float columns_per_radian;
  float last_column;
  float pitch_cosine;
  float pitch_sine;
};

// Column, range, levelled horizontal range and height of points. Without branches, as azimuthOf().
SAW_NDT_VECTOR_CODE void measureBlock(std::size_t count, const BlockGeometry geometry, const float* __restrict x,
                                      const float* __restrict y, const float* __restrict z,
                                      std::int32_t* __restrict column, float* __restrict range,
                                      float* __restrict horizontal_range, float* __restrict height) {
  for (std::size_t i = 0; i < count; ++i) {
    const float squared_range = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
    // Not a number compares false; an infinite coordinate, or one whose square overflows, gives infinity.
    const bool valid = squared_range > 0.0F && squared_range <= std::numeric_limits<float>::max();
    const float safe_squared_range = valid ? squared_range : 0.0F;
    const float place = valid ? azimuthOf(x[i], y[i]) * geometry.columns_per_radian : 0.0F;
    const float level_height = geometry.pitch_cosine * z[i] - geometry.pitch_sine * x[i];
    const float squared_horizontal_range = safe_squared_range - level_height * level_height;
    column[i] = static_cast<std::int32_t>(place < geometry.last_column ? place : geometry.last_column);
    range[i] = std::sqrt(safe_squared_range);
    horizontal_range[i] = std::sqrt(squared_horizontal_range > 0.0F ? squared_horizontal_range : 0.0F);
    height[i] = level_height;
  }
}

// `taken` where all bits of the mask are 1, `held` where they are 0.
inline float blend(std::uint32_t mask, float taken, float held) {
  std::uint32_t taken_bits;
  std::uint32_t held_bits;
  std::memcpy(&taken_bits, &taken, sizeof(taken));
  std::memcpy(&held_bits, &held, sizeof(held));
  const std::uint32_t bits = (taken_bits & mask) | (held_bits & ~mask);
  float result;
  std::memcpy(&result, &bits, sizeof(result));
  return result;
}

}  // namespace

void RangeImage::measurePoints(const ScanView& scan, double mounting_pitch) {
  points_.column.resize(scan.size);
  points_.range.resize(scan.size);
  points_.horizontal_range.resize(scan.size);
  points_.height.resize(scan.size);
  const BlockGeometry geometry = {static_cast<float>(columns_) / kTurn, static_cast<float>(columns_ - 1),
                                  static_cast<float>(std::cos(mounting_pitch)),
                                  static_cast<float>(std::sin(mounting_pitch))};
  std::array<float, kBlock> x;
  std::array<float, kBlock> y;
  std::array<float, kBlock> z;
  for (std::size_t begin = 0; begin < scan.size; begin += kBlock) {
    const std::size_t count = std::min(kBlock, scan.size - begin);
    for (std::size_t i = 0; i < count; ++i) {
      const float* point = scan.point(begin + i);
      x[i] = point[0];
      y[i] = point[1];
      z[i] = point[2];
    }
    measureBlock(count, geometry, x.data(), y.data(), z.data(), points_.column.data() + begin,
                 points_.range.data() + begin, points_.horizontal_range.data() + begin, points_.height.data() + begin);
  }
}

void RangeImage::project(const ScanView& scan, const SensorModel& sensor, double mounting_pitch) {
  sensor.check();
  if (scan.size > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    throw std::invalid_argument("scan: more than 2^31 - 1 points");
  }
  rows_ = sensor.rows();
  columns_ = sensor.columns;
  measurePoints(scan, mounting_pitch);
  ring_index_.assign(scan, points_, sensor);

  placePoints(scan.size);
}

void RangeImage::placePoints(std::size_t point_count) {
  const std::size_t pixels = static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_);
  range_.assign(pixels, 0.0F);
  horizontal_range_.resize(pixels);
  height_.resize(pixels);
  returns_.assign(pixels, 0);
  pixel_of_point_.resize(point_count);
  float* const range = range_.data();
  float* const horizontal_range = horizontal_range_.data();
  float* const height = height_.data();
  std::uint16_t* const returns = returns_.data();
  std::int32_t* const pixel_of_point = pixel_of_point_.data();
  const std::int16_t* const row_of_point = ring_index_.rows().data();
  const float* const point_range = points_.range.data();
  const std::int32_t* const point_column = points_.column.data();
  const float* const point_horizontal_range = points_.horizontal_range.data();
  const float* const point_height = points_.height.data();
  const std::int32_t columns = columns_;
  for (std::size_t i = 0; i < point_count; ++i) {
    const std::int32_t row = row_of_point[i];
    if (point_range[i] <= 0.0F || row == RingIndex::kNoRow) {
      pixel_of_point[i] = kNoPixel;
      continue;
    }
    const std::int32_t pixel = row * columns + point_column[i];
    pixel_of_point[i] = pixel;
    returns[pixel] =
        static_cast<std::uint16_t>(returns[pixel] + (returns[pixel] != std::numeric_limits<std::uint16_t>::max()));
    // Which return is nearer is as good as random, so it must not be a branch: blend bits instead.
    const float held = range[pixel];
    const bool takes = (held <= 0.0F) | (point_range[i] < held);
    const std::uint32_t mask = 0U - static_cast<std::uint32_t>(takes);
    range[pixel] = blend(mask, point_range[i], held);
    horizontal_range[pixel] = blend(mask, point_horizontal_range[i], horizontal_range[pixel]);
    height[pixel] = blend(mask, point_height[i], height[pixel]);
  }
}

}  // namespace saw_ndt
