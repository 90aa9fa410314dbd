#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "saw_ndt/common/scan_view.h"
#include "segmentation/scan_projection.h"

namespace saw_ndt::internal {

/// Least and greatest column of some points; the least is above the greatest where none of them has a column.
struct ColumnSpan {
  std::uint16_t least;
  std::uint16_t greatest;
};

/// What projection needs of every point, in input order. Memory is kept between scans.
struct PointMeasurements {
  /// Column of a point that is not finite or at the origin.
  static constexpr std::uint16_t kNoColumn = 0xFFFF;
  /// How many points share an element of `spans`.
  static constexpr std::size_t kBlock = 128;

  std::vector<std::uint16_t> column;    ///< of the range image, or kNoColumn
  std::vector<float> range;             ///< metres; 0 where the point is not finite or at the origin
  std::vector<float> horizontal_range;  ///< metres, levelled
  std::vector<float> height;            ///< metres, levelled
  std::vector<ColumnSpan> spans;        ///< of every kBlock points

  /// Sine of a point's elevation in the frame of the sensor; only where it has a range.
  float elevationSine(const ScanView& scan, std::size_t index) const { return scan.point(index)[2] / range[index]; }
};

/// Measures the points of a scan for an image of so many columns a turn. The result does not depend on the number of
/// threads.
void measureScan(const ScanView& scan, const ScanProjection& projection, int columns, int threads,
                 PointMeasurements& points);

}  // namespace saw_ndt::internal
