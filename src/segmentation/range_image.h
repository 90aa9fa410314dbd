#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/common/sensor_model.h"
#include "segmentation/pixel_image.h"
#include "segmentation/ring_index.h"
#include "segmentation/scan_projection.h"

namespace saw_ndt::internal {

/// A scan projected by vertical scan index and azimuth (section III.A of the paper). Row 0 is the beam that looks up
/// highest; column 0 begins straight ahead and columns count counter-clockwise, seen from the top of the sensor.
/// Memory is kept from one project() to the next.
class RangeImage : public PixelImage {
 public:
  /// No pixel: see pixelOfPoint().
  static constexpr std::int32_t kNoPixel = -1;

  /// Projects a scan. Where several points share a pixel, the nearest to the sensor stands for it. Throws
  /// std::invalid_argument where the sensor model is not valid or the scan has more than 2^31 - 1 points. The image
  /// does not depend on the number of threads.
  void project(const ScanView& scan, const SensorModel& sensor, const ScanProjection& projection = {}, int threads = 1);

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

  void placeRun(const RowRun& run, PixelReturns& returns);
  void placeInAnyOrder(PixelReturns& returns);
  void placePoints(std::size_t begin, std::size_t end, std::size_t first_pixel, std::size_t pixels,
                   PixelReturns& returns);

  bool upside_down_ = false;
  std::vector<std::uint16_t> returns_;
  std::vector<std::int32_t> pixel_of_point_;
  PointMeasurements points_;
  RingIndex ring_index_;
  std::vector<RowRun> run_of_row_;
  std::vector<PixelReturns> pixel_returns_;  ///< one a thread
};

}  // namespace saw_ndt::internal
