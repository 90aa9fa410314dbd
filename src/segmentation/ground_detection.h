#pragma once

#include <cstdint>
#include <vector>

#include "saw_ndt/common/sensor_model.h"
#include "saw_ndt/segmentation/segmentation_options.h"
#include "segmentation/pixel_image.h"

namespace saw_ndt::internal {

/// Finds ground in images of columns that lead outward. Memory is kept from one image to the next.
class GroundDetection {
 public:
  /// Writes 1 for every pixel of the image that is ground and 0 for every other, row-major. The options have been
  /// checked, and the image was projected with the sensor model. In one thread: handing parts to others would take as
  /// long.
  void detect(const PixelImage& image, const SensorModel& sensor, const GroundOptions& options,
              std::vector<std::uint8_t>& ground);

  /// Height of the sensor above the ground (m) that ground was followed from in the last image.
  float sensorHeight() const { return sensor_height_; }

 private:
  /// Sums over three rows, with one column more at either side.
  struct NeighbourSums {
    std::vector<std::uint8_t> returns;
    std::vector<std::uint8_t> ground;
  };

  static void detectByInclination(const PixelImage& image, const SensorModel& sensor, const GroundOptions& options,
                                  std::vector<std::uint8_t>& ground);
  float estimatedSensorHeight(const PixelImage& image, const GroundOptions& options);
  void grow(const PixelImage& image, const GroundOptions& options, std::size_t first_column, std::size_t columns);
  void doubtFeet(const PixelImage& image, const SensorModel& sensor, const GroundOptions& options);
  void settle(const PixelImage& image, int row, bool smooths, NeighbourSums& sums,
              std::vector<std::uint8_t>& ground) const;

  float sensor_height_ = 0.0F;
  std::vector<float> last_range_;
  std::vector<float> last_height_;
  std::vector<float> profile_height_;
  std::vector<float> obstacle_range_;
  std::vector<float> obstacle_height_;
  std::vector<float> candidate_heights_;
  std::vector<std::uint8_t> states_;
  std::vector<std::uint8_t> no_returns_;
  NeighbourSums neighbour_sums_;
};

}  // namespace saw_ndt::internal
