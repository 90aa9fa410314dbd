#pragma once

#include <cstdint>
#include <vector>

#include "saw_ndt/segmentation/range_image.h"
#include "saw_ndt/segmentation/sensor_model.h"

namespace saw_ndt {

/// How ground is told in a range image.
enum class GroundRule {
  /// The paper's and LeGO-LOAM's: the line between vertically adjacent pixels is nearly level.
  Inclination,
  /// Ground is followed outward from below the sensor, column by column: a return belongs to it where it lies on from
  /// the
  /// last ground return and near the height that ground may have reached by then; then neighbours settle what is
  /// doubtful.
  Growing,
};

/// Options of GroundDetection.
struct GroundOptions {
  /// Which rule applies.
  GroundRule rule = GroundRule::Growing;

  /// Inclination: greatest inclination in degrees between vertically adjacent pixels of ground, 0 to 90.
  double inclination_limit_deg = 10.0;
  /// Inclination: beams above this elevation in degrees never see ground. The default leaves an HDL-64E its lowest 50
  /// beams.
  double inclination_top_elevation_deg = -2.0;

  /// Growing: height of the sensor above ground in metres; 0: estimated in each scan.
  double sensor_height_m = 0.0;
  /// Growing: greatest slope in degrees from one ground return to the next of the same column, 0 to 60.
  double step_slope_deg = 7.0;
  /// Growing: what the height of the next ground return may miss beyond that slope, in metres: roughness and range
  /// noise.
  double step_tolerance_m = 0.06;
  /// Growing: greatest slope in degrees that ground follows over longer distances, 0 to 60.
  double profile_slope_deg = 6.0;
  /// Growing: what ground may stand out from that slower profile, in metres: a kerb.
  double profile_tolerance_m = 0.15;
  /// Growing: how often each pixel is compared with its neighbours, 0 to 10.
  int smoothing_passes = 2;

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// Finds ground in range images. Memory is kept from one image to the next.
class GroundDetection {
 public:
  /// Writes 1 for every pixel of the image that is ground and 0 for every other, row-major. The options have been
  /// checked, and the image was projected with the sensor model.
  void detect(const RangeImage& image, const SensorModel& sensor, const GroundOptions& options,
              std::vector<std::uint8_t>& ground);

 private:
  static void detectByInclination(const RangeImage& image, const SensorModel& sensor, const GroundOptions& options,
                                  std::vector<std::uint8_t>& ground);
  void grow(const RangeImage& image, const GroundOptions& options, std::vector<std::uint8_t>& ground);
  float estimatedSensorHeight(const RangeImage& image, const GroundOptions& options);
  void smooth(const RangeImage& image, std::vector<std::uint8_t>& ground);

  std::vector<float> last_range_;
  std::vector<float> last_height_;
  std::vector<float> profile_height_;
  std::vector<float> candidate_heights_;
  std::vector<std::uint8_t> before_;
  std::vector<std::uint8_t> column_returns_;
  std::vector<std::uint8_t> column_ground_;
};

}  // namespace saw_ndt
