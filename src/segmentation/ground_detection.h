#pragma once

#include <cstdint>
#include <vector>

#include "saw_ndt/common/sensor_model.h"
#include "segmentation/range_image.h"

namespace saw_ndt {

/// How ground is told in a range image.
enum class GroundRule {
  /// The paper's and LeGO-LOAM's: the line between vertically adjacent pixels is nearly level.
  Inclination,
  /// Ground is followed outward from below the sensor, column by column: a return belongs to it where it lies on from
  /// the last ground return and near the height that ground may have reached by then; then neighbours settle what is
  /// doubtful.
  Growing,
};

/// Options of GroundDetection.
struct GroundOptions {
  /// Which rule applies.
  GroundRule rule = GroundRule::Growing;

  /// Inclination: greatest inclination in degrees between vertically adjacent pixels of ground, 0 to 90.
  double inclination_limit_deg = 10.0;
  /// Inclination: beams above this elevation in degrees never see ground. An HDL-64E is left its lowest 51 beams.
  double inclination_top_elevation_deg = -2.0;

  /// Growing: height of the sensor above ground in metres; 0: estimated in each scan.
  double sensor_height_m = 0.0;
  /// Growing: greatest slope of ground in degrees, 0 to 60.
  double slope_deg = 8.0;
  /// Growing: by how many metres the height of a ground return may miss that of the last one in its column, beyond the
  /// slope: roughness and range noise.
  double step_tolerance_m = 0.06;
  /// Growing: by how many metres ground may stand out from a profile that rises no faster than the slope: a kerb. It
  /// keeps ground from climbing a wall by many small steps.
  double profile_tolerance_m = 0.15;
  /// Growing: whether each pixel is compared with its eight neighbours at last.
  bool smooths = true;

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// Finds ground in range images. Memory is kept from one image to the next.
class GroundDetection {
 public:
  /// Writes 1 for every pixel of the image that is ground and 0 for every other, row-major. The options have been
  /// checked, and the image was projected with the sensor model. The result does not depend on the number of threads.
  void detect(const RangeImage& image, const SensorModel& sensor, const GroundOptions& options,
              std::vector<std::uint8_t>& ground, int threads = 1);

 private:
  /// Sums over three rows, with one column more at either side.
  struct NeighbourSums {
    std::vector<std::uint8_t> returns;
    std::vector<std::uint8_t> ground;
  };

  static void detectByInclination(const RangeImage& image, const SensorModel& sensor, const GroundOptions& options,
                                  std::vector<std::uint8_t>& ground);
  float estimatedSensorHeight(const RangeImage& image, const GroundOptions& options);
  void grow(const RangeImage& image, const GroundOptions& options, std::size_t first_column, std::size_t columns);
  void settle(const RangeImage& image, int row, bool smooths, NeighbourSums& sums,
              std::vector<std::uint8_t>& ground) const;

  std::vector<float> last_range_;
  std::vector<float> last_height_;
  std::vector<float> profile_height_;
  std::vector<float> candidate_heights_;
  std::vector<std::uint8_t> states_;
  std::vector<std::uint8_t> no_returns_;
  std::vector<NeighbourSums> neighbour_sums_;  ///< one a thread
};

}  // namespace saw_ndt
