#include "simulation/lidar_options.h"

#include <cmath>

#include "saw_ndt/common/error.h"

namespace saw_ndt {
namespace {

void checkNotNegative(double value, const char* name) {
  checkOption(value >= 0.0 && std::isfinite(value), name, value, "0 or more");
}

void checkPositive(double value, const char* name) {
  checkOption(value > 0.0 && std::isfinite(value), name, value, "positive");
}

void checkShare(double value, const char* name) { checkOption(value >= 0.0 && value <= 1.0, name, value, "0 to 1"); }

}  // namespace

void LidarOptions::check() const {
  sensor.check();
  checkOption(firings_per_turn >= 64 && firings_per_turn <= 65536, "firings_per_turn", firings_per_turn, "64 to 65536");
  checkPositive(scan_period_s, "scan_period_s");
  checkPositive(min_range_m, "min_range_m");
  checkOption(max_range_m > min_range_m && std::isfinite(max_range_m), "max_range_m", max_range_m,
              "greater than min_range_m");
  checkOption(own_vehicle.isEmpty() || !own_vehicle.contains(Eigen::Vector3f::Zero()), "own_vehicle",
              own_vehicle.isEmpty() ? 0.0F : own_vehicle.max().z(), "beside the LiDAR");
  checkNotNegative(range_noise_m, "range_noise_m");
  checkNotNegative(beam_range_offset_m, "beam_range_offset_m");
  checkNotNegative(angle_jitter_rad, "angle_jitter_rad");
  checkNotNegative(beam_divergence_rad, "beam_divergence_rad");
  checkNotNegative(pulse_length_m, "pulse_length_m");
  checkPositive(edge_step_m, "edge_step_m");
  checkPositive(detection_range_m, "detection_range_m");
  checkNotNegative(power_fluctuation, "power_fluctuation");
  checkNotNegative(surface_roughness_rad, "surface_roughness_rad");
  checkShare(dropout_share, "dropout_share");
  checkShare(rain_share, "rain_share");
  checkPositive(rain_mean_range_m, "rain_mean_range_m");
}

LidarOptions LidarOptions::named(const std::string& sensor) {
  LidarOptions options;
  options.sensor = SensorModel::named(sensor);
  if (sensor == "HDL-64E") return options;

  // These stand on a mast rather than behind the edge of a roof.
  options.own_vehicle.setEmpty();
  options.range_noise_m = 0.015;
  options.beam_divergence_rad = 3e-3;
  if (sensor == "HDL-32E") {
    options.firings_per_turn = 2172;
    options.detection_range_m = 55.0;
  } else if (sensor == "VLP-16") {
    options.firings_per_turn = 1800;
    options.max_range_m = 100.0;
    options.detection_range_m = 50.0;
  } else {
    options.firings_per_turn = options.sensor.columns;
    options.max_range_m = 120.0;
    options.detection_range_m = 45.0;
  }
  return options;
}

}  // namespace saw_ndt
