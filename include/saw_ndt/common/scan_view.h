#pragma once

#include <cstddef>
#include <cstdint>

namespace saw_ndt {

/// One scan as segmentation reads it, whatever the point type: nothing is copied, nothing is owned.
struct ScanView {
  /// x of the first point; y and z follow it. Metres, LiDAR frame: x forward, y left, z up.
  const float* xyz = nullptr;
  /// Floats from one point's x to the next one's (at least 3).
  std::size_t stride = 4;
  /// Number of points.
  std::size_t size = 0;
  /// Ring number of each point, or null where the points have none. Rings may be numbered from the top or the bottom.
  const std::uint16_t* rings = nullptr;
  /// Points per row of an organized cloud; ignored where height is 1.
  std::size_t width = 0;
  /// Rows of an organized cloud, 1 for an unorganized one.
  std::size_t height = 1;

  const float* point(std::size_t index) const { return xyz + index * stride; }
};

}  // namespace saw_ndt
