#include "segmentation/range_image.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "common/executor.h"
#include "saw_ndt/common/geometry.h"
#include "segmentation/range_image_loops.h"

namespace saw_ndt::internal {
namespace {

constexpr auto kMostReturns = std::numeric_limits<std::uint16_t>::max();

std::uint32_t bitsOf(float value) {
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof(bits));
  return bits;
}

float floatOf(std::uint32_t bits) {
  float value;
  std::memcpy(&value, &bits, sizeof(value));
  return value;
}

// Finds the nearest return of each pixel and how many there are; see RangeImage::PixelReturns. Which return is nearer
// is as good as random, so it must not be a branch.
template <bool kSaturates>
void findNearest(std::size_t points, const std::int32_t* pixel_of_point, const float* range, std::uint32_t first_pixel,
                 std::uint32_t pixels, std::uint64_t* nearest, std::uint16_t* count) {
  for (std::size_t i = 0; i < points; ++i) {
    const std::uint32_t from_first = static_cast<std::uint32_t>(pixel_of_point[i]) - first_pixel;
    const std::uint32_t pixel = std::min(from_first, pixels);  // that of no pixel is huge
    const bool counts = !kSaturates || count[pixel] != kMostReturns;
    count[pixel] = static_cast<std::uint16_t>(count[pixel] + counts);
    const std::uint64_t key = static_cast<std::uint64_t>(bitsOf(range[i])) << 32 | i;
    nearest[pixel] = std::min(nearest[pixel], key);
  }
}

}  // namespace

void RangeImage::project(const ScanView& scan, const SensorModel& sensor, const ScanProjection& projection,
                         int threads) {
  sensor.check();
  if (scan.size > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    throw std::invalid_argument("scan: more than 2^31 - 1 points");
  }
  rows_ = sensor.rows();
  columns_ = sensor.columns;
  upside_down_ = projection.isUpsideDown();
  measureScan(scan, projection, columns_, threads, points_);
  ring_index_.assign(scan, points_, sensor);

  const std::size_t pixels = static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_);
  range_.resize(pixels);
  horizontal_range_.resize(pixels);
  height_.resize(pixels);
  returns_.resize(pixels);
  pixel_of_point_.resize(scan.size);
  if (pixel_returns_.size() < static_cast<std::size_t>(threads)) {
    pixel_returns_.resize(static_cast<std::size_t>(threads));
  }
  if (!ring_index_.rowAfterRow()) {
    placeInAnyOrder(pixel_returns_[0]);
    return;
  }
  run_of_row_.resize(static_cast<std::size_t>(rows_));
  for (int row = 0; row < rows_; ++row) run_of_row_[row] = {0, 0, static_cast<std::int16_t>(row)};
  for (RowRun run : ring_index_.runs()) {
    if (upside_down_) run.row = static_cast<std::int16_t>(rows_ - 1 - run.row);
    run_of_row_[run.row] = run;
  }
  for (PixelReturns& returns : pixel_returns_) {
    returns.nearest.resize(static_cast<std::size_t>(columns_) + 1);
    returns.count.resize(static_cast<std::size_t>(columns_) + 1);
  }
  constexpr std::size_t kRowsAtOnce = 4;
  const std::size_t rows = run_of_row_.size();
  internal::forEachChunk(threads, (rows + kRowsAtOnce - 1) / kRowsAtOnce, [&](std::size_t chunk, int worker) {
    const std::size_t end = std::min(rows, (chunk + 1) * kRowsAtOnce);
    for (std::size_t row = chunk * kRowsAtOnce; row < end; ++row) placeRun(run_of_row_[row], pixel_returns_[worker]);
  });
}

void RangeImage::placeRun(const RowRun& run, PixelReturns& returns) {
  const auto columns = static_cast<std::size_t>(columns_);
  const std::size_t first_pixel = static_cast<std::size_t>(run.row) * columns;
  pixelsOfColumns(run.end - run.begin, points_.column.data() + run.begin, static_cast<std::int32_t>(first_pixel),
                  pixel_of_point_.data() + run.begin);
  placePoints(run.begin, run.end, first_pixel, columns, returns);
}

void RangeImage::placeInAnyOrder(PixelReturns& returns) {
  const std::size_t pixels = range_.size();
  const std::vector<std::int16_t>& row_of_point = ring_index_.rows();
  for (std::size_t i = 0; i < pixel_of_point_.size(); ++i) {
    const bool seen = points_.column[i] != PointMeasurements::kNoColumn && row_of_point[i] != RingIndex::kNoRow;
    const int row = upside_down_ ? rows_ - 1 - row_of_point[i] : row_of_point[i];
    pixel_of_point_[i] = seen ? row * columns_ + points_.column[i] : kNoPixel;
  }
  returns.nearest.resize(pixels + 1);
  returns.count.resize(pixels + 1);
  placePoints(0, pixel_of_point_.size(), 0, pixels, returns);
}

void RangeImage::placePoints(std::size_t begin, std::size_t end, std::size_t first_pixel, std::size_t pixels,
                             PixelReturns& returns) {
  const std::uint64_t no_return = static_cast<std::uint64_t>(bitsOf(std::numeric_limits<float>::infinity())) << 32;
  std::uint64_t* const nearest = returns.nearest.data();
  std::uint16_t* const count = returns.count.data();
  std::fill_n(nearest, pixels + 1, no_return);
  std::fill_n(count, pixels + 1, std::uint16_t{0});
  const auto find_nearest = end - begin <= kMostReturns ? &findNearest<false> : &findNearest<true>;
  find_nearest(end - begin, pixel_of_point_.data() + begin, points_.range.data() + begin,
               static_cast<std::uint32_t>(first_pixel), static_cast<std::uint32_t>(pixels), nearest, count);

  float* const range = range_.data() + first_pixel;
  float* const horizontal_range = horizontal_range_.data() + first_pixel;
  float* const height = height_.data() + first_pixel;
  if (begin == end) {
    std::fill_n(range, pixels, 0.0F);
    std::fill_n(returns_.data() + first_pixel, pixels, std::uint16_t{0});
    return;
  }
  const float* const point_horizontal_range = points_.horizontal_range.data() + begin;
  const float* const point_height = points_.height.data() + begin;
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    const std::uint64_t key = nearest[pixel];
    const auto point = static_cast<std::uint32_t>(key);  // the first one where there is no return
    range[pixel] = key == no_return ? 0.0F : floatOf(static_cast<std::uint32_t>(key >> 32));
    horizontal_range[pixel] = point_horizontal_range[point];
    height[pixel] = point_height[point];
  }
  std::copy_n(count, pixels, returns_.data() + first_pixel);
}

}  // namespace saw_ndt::internal
