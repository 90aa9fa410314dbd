#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/common/sensor_model.h"
#include "segmentation/ring_index.h"

namespace saw_ndt::internal {

/// A scan projected by vertical scan index and azimuth (section III.A of the paper). Row 0 is the top beam; column 0
/// begins straight ahead and columns count counter-clockwise. All images are row-major, rows() x columns().
/// Memory is kept from one project() to the next.
class RangeImage {
 public:
  /// No pixel: see pixelOfPoint().
  static constexpr std::int32_t kNoPixel = -1;

  /// Projects a scan. Heights are levelled by the mounting pitch: the angle in radians by which the sensor's x axis
  /// points below the horizon. Where several points share a pixel, the nearest to the sensor stands for it. Throws
  /// std::invalid_argument where the sensor model is not valid or the scan has more than 2^31 - 1 points. The image
  /// does not depend on the number of threads.
  void project(const ScanView& scan, const SensorModel& sensor, double mounting_pitch = 0.0, int threads = 1);

  int rows() const { return rows_; }
  int columns() const { return columns_; }

  /// Distance from the sensor in metres; 0 where there is no return.
  const std::vector<float>& range() const { return range_; }
  /// Levelled distance from the vertical axis of the sensor in metres; defined where range() is not 0.
  const std::vector<float>& horizontalRange() const { return horizontal_range_; }
  /// Levelled height above the sensor in metres; defined where range() is not 0.
  const std::vector<float>& height() const { return height_; }
  /// How many points fell into the pixel, at most 65535.
  const std::vector<std::uint16_t>& returns() const { return returns_; }

  /// Pixel index row * columns() + column of every point in input order; kNoPixel where it is not finite, at the
  /// sensor's origin, or outside of what the sensor sees.
  const std::vector<std::int32_t>& pixelOfPoint() const { return pixel_of_point_; }

  /// Where the rows came from in the last project().
  VerticalIndexSource verticalIndexSource() const { return ring_index_.source(); }

 private:
  /// The returns of some pixels while points are placed, and one element more, for points that are in none of them.
  struct PixelReturns {
    /// Range of the nearest return as bits, above the number of its point: the least of such keys is the nearest, and
    /// the first of several that are as near.
    std::vector<std::uint64_t> nearest;
    std::vector<std::uint16_t> count;
  };

  void measure(const ScanView& scan, double mounting_pitch, int threads);
  void placeRun(const RowRun& run, PixelReturns& returns);
  void placeInAnyOrder(PixelReturns& returns);
  void placePoints(std::size_t begin, std::size_t end, std::size_t first_pixel, std::size_t pixels,
                   PixelReturns& returns);

  int rows_ = 0;
  int columns_ = 0;
  std::vector<float> range_;
  std::vector<float> horizontal_range_;
  std::vector<float> height_;
  std::vector<std::uint16_t> returns_;
  std::vector<std::int32_t> pixel_of_point_;
  PointMeasurements points_;
  RingIndex ring_index_;
  std::vector<RowRun> run_of_row_;
  std::vector<PixelReturns> pixel_returns_;  ///< one a thread
};

}  // namespace saw_ndt::internal
