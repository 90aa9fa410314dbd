#pragma once

#include <vector>

namespace saw_ndt::internal {

/// What surrounds a sensor, seen column by column: from the last row to row 0 a column leads outward over the ground.
/// Row-major, rows() x columns(); the last column is beside the first.
class PixelImage {
 public:
  int rows() const { return rows_; }
  int columns() const { return columns_; }

  /// Distance from the sensor in metres; 0 where there is no return.
  const std::vector<float>& range() const { return range_; }
  /// Levelled distance from the vertical axis of the sensor in metres; defined where range() is not 0.
  const std::vector<float>& horizontalRange() const { return horizontal_range_; }
  /// Levelled height above the sensor in metres; defined where range() is not 0.
  const std::vector<float>& height() const { return height_; }

 protected:
  PixelImage() = default;
  ~PixelImage() = default;
  PixelImage(const PixelImage&) = default;
  PixelImage& operator=(const PixelImage&) = default;

  int rows_ = 0;
  int columns_ = 0;
  std::vector<float> range_;
  std::vector<float> horizontal_range_;
  std::vector<float> height_;
};

}  // namespace saw_ndt::internal
