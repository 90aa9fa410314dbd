#include "saw_ndt/segmentation/range_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "saw_ndt/common/geometry.h"

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

}  // namespace

void RangeImage::measurePoints(const ScanView& scan, double mounting_pitch) {
  points_.azimuth.resize(scan.size);
  points_.range.resize(scan.size);
  points_.horizontal_range.resize(scan.size);
  points_.height.resize(scan.size);
  const auto cosine = static_cast<float>(std::cos(mounting_pitch));
  const auto sine = static_cast<float>(std::sin(mounting_pitch));
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
    float* azimuth = points_.azimuth.data() + begin;
    float* range = points_.range.data() + begin;
    float* horizontal_range = points_.horizontal_range.data() + begin;
    float* height = points_.height.data() + begin;
    for (std::size_t i = 0; i < count; ++i) {
      const float squared_range = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
      // Not a number compares false; an infinite coordinate, or one whose square overflows, gives infinity.
      const bool valid = squared_range > 0.0F && squared_range <= std::numeric_limits<float>::max();
      const float level_height = cosine * z[i] - sine * x[i];
      azimuth[i] = azimuthOf(x[i], y[i]);
      range[i] = valid ? std::sqrt(squared_range) : 0.0F;
      height[i] = level_height;
      horizontal_range[i] = std::sqrt(std::max(squared_range - level_height * level_height, 0.0F));
    }
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

  const std::size_t pixels = static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_);
  range_.assign(pixels, 0.0F);
  horizontal_range_.resize(pixels);
  height_.resize(pixels);
  pixel_of_point_.resize(scan.size);
  const float columns_per_radian = static_cast<float>(columns_) / kTurn;
  const std::vector<std::int16_t>& row_of_point = ring_index_.rows();
  for (std::size_t i = 0; i < scan.size; ++i) {
    const float range = points_.range[i];
    const std::int32_t row = row_of_point[i];
    if (range <= 0.0F || row == RingIndex::kNoRow) {
      pixel_of_point_[i] = kNoPixel;
      continue;
    }
    const auto column = std::min(static_cast<std::int32_t>(points_.azimuth[i] * columns_per_radian), columns_ - 1);
    const std::int32_t pixel = row * columns_ + column;
    pixel_of_point_[i] = pixel;
    if (range_[pixel] > 0.0F && range_[pixel] <= range) continue;
    range_[pixel] = range;
    horizontal_range_[pixel] = points_.horizontal_range[i];
    height_[pixel] = points_.height[i];
  }
}

}  // namespace saw_ndt
