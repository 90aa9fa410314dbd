#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "map/direction_loops.h"
#include "saw_ndt/common/scan_view.h"

namespace saw_ndt::internal {

/// How far a scan sees in each direction, on even steps of azimuth and elevation around the LiDAR. It knows nothing of
/// beams, so that a solid angle is a rectangle of pixels for any LiDAR. Memory is kept from one make() to the next.
class DirectionImage {
 public:
  static constexpr int kColumns = 720, kRows = kColumns / 2;
  static constexpr float kPixelsPerRadian = static_cast<float>(kColumns / 6.283185307179586);

  DirectionImage();

  /// Puts the returns of a scan into it. What is nearer than `least_range_m` is left out.
  void make(const ScanView& scan, float least_range_m);

  /// The pixels of the image, for points within these ranges.
  static DirectionGrid grid(float least_range_m, float greatest_range_m) {
    return {kColumns, kRows, kPixelsPerRadian, least_range_m, greatest_range_m};
  }

  /// Whether there are rays in a pixel, and all of them, and all around it, end beyond a range (m). Between two rays of
  /// a column, one above the other and at most 4 degrees apart, what is not known counts as the nearer of both.
  /// @param reach  how far around, in pixels; at least one
  bool endsBeyond(std::int32_t pixel, float range_m, float reach) const {
    const auto place = static_cast<std::size_t>(pixel);
    if (nearest_[place] == kNoRay || nearest_[place] < range_m) return false;
    const int window = reach <= 1.0F ? 0 : reach <= 2.0F ? 1 : reach <= 4.0F ? 2 : 3;
    return least_[static_cast<std::size_t>(window)][place] >= range_m;
  }

 private:
  // Where there is no ray.
  static constexpr float kNoRay = std::numeric_limits<float>::infinity();
  // From a beam to the next one below, in pixels.
  static constexpr int kMostGap = 8;
  // Windows reach 2^k pixels to each side of a pixel, k below this.
  static constexpr int kWindows = 4;

  void place(const ScanView& scan, float least_range_m);
  void fillBetweenBeams();
  void spread();

  std::vector<float> nearest_;                      // range of the nearest return in each pixel
  std::vector<float> filled_;                       // the same, with what is assumed between beams
  std::array<std::vector<float>, kWindows> least_;  // of filled_, in the window around each pixel
  std::vector<float> along_rows_;                   // of spread()
  int first_row_ = kRows, last_row_ = -1;           // which hold returns
};

}  // namespace saw_ndt::internal
