#include "simulation/lidar_options.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {
namespace {

void checkNotNegative(double value, const char* name) {
  checkOption(value >= 0.0 && std::isfinite(value), name, value, "0 or more");
}

void checkPositive(double value, const char* name) {
  checkOption(value > 0.0 && std::isfinite(value), name, value, "positive");
}

void checkShare(double value, const char* name) { checkOption(value >= 0.0 && value <= 1.0, name, value, "0 to 1"); }

/// About what data sheets say of a LiDAR at ten turns a second; fields as in LidarOptions.
struct DataSheet {
  const char* name;
  int firings_per_turn;
  double min_range_m, max_range_m, detection_range_m, range_noise_m, beam_divergence_rad, field_of_view_deg;
};

// Ranges at which a reflectivity of 0.1 is detected are the makers', but for the older Velodynes and RoboSenses, of
// which they name none: they reach less far than they say.
constexpr DataSheet kDataSheets[] = {
    {"HDL-32E", 2172, 1.0, 80.0, 55.0, 0.015, 3e-3, 360.0},
    {"VLP-16", 1800, 1.0, 100.0, 50.0, 0.015, 3e-3, 360.0},
    {"VLP-32C", 1808, 1.0, 200.0, 80.0, 0.015, 3e-3, 360.0},
    {"VLS-128", 1876, 1.0, 245.0, 180.0, 0.015, 2e-3, 360.0},
    {"OS0-32", 1024, 0.3, 50.0, 15.0, 0.015, 6e-3, 360.0},
    {"OS0-64", 1024, 0.3, 50.0, 15.0, 0.015, 6e-3, 360.0},
    {"OS0-128", 1024, 0.3, 50.0, 15.0, 0.015, 6e-3, 360.0},
    {"OS1-32", 1024, 1.0, 120.0, 45.0, 0.015, 3e-3, 360.0},
    {"OS1-64", 1024, 1.0, 120.0, 45.0, 0.015, 3e-3, 360.0},
    {"OS1-64-gen1", 1024, 1.0, 120.0, 40.0, 0.015, 3e-3, 360.0},
    {"OS1-128", 1024, 1.0, 120.0, 45.0, 0.015, 3e-3, 360.0},
    {"OS-64", 1024, 1.0, 120.0, 45.0, 0.015, 3e-3, 360.0},
    {"OS-128", 1024, 1.0, 120.0, 45.0, 0.015, 3e-3, 360.0},
    {"OS2-32", 1024, 1.0, 240.0, 80.0, 0.025, 1.6e-3, 360.0},
    {"OS2-64", 1024, 1.0, 240.0, 80.0, 0.025, 1.6e-3, 360.0},
    {"OS2-128", 1024, 1.0, 240.0, 80.0, 0.025, 1.6e-3, 360.0},
    {"Pandar40P", 1800, 0.3, 200.0, 200.0, 0.01, 3e-3, 360.0},
    {"Pandar64", 1800, 0.3, 200.0, 200.0, 0.01, 3e-3, 360.0},
    {"QT64", 600, 0.1, 60.0, 20.0, 0.015, 7e-3, 360.0},
    {"XT32", 2000, 0.1, 120.0, 80.0, 0.007, 2e-3, 360.0},
    {"AT128", 3600, 0.5, 210.0, 210.0, 0.01, 2e-3, 120.0},
    {"RS-16", 1800, 0.4, 150.0, 55.0, 0.015, 3e-3, 360.0},
    {"RS-32", 1800, 0.4, 200.0, 80.0, 0.015, 3e-3, 360.0},
    {"RS-128", 1800, 0.4, 250.0, 200.0, 0.015, 2e-3, 360.0},
};

}  // namespace

void LidarOptions::check() const {
  sensor.check();
  checkOption(sensor.rows() > 0, "sensor", sensor.name, "a LiDAR with beams: no others are simulated");
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
  checkOption(field_of_view_deg > 0.0 && field_of_view_deg <= 360.0, "field_of_view_deg", field_of_view_deg,
              "between 0, exclusive, and 360");
  checkOption(std::abs(mounting_roll_deg) <= 180.0, "mounting_roll_deg", mounting_roll_deg, "between -180 and 180");
  checkOption(std::abs(mounting_pitch_deg) <= 90.0, "mounting_pitch_deg", mounting_pitch_deg, "between -90 and 90");
  checkShare(rain_share, "rain_share");
  checkPositive(rain_mean_range_m, "rain_mean_range_m");
}

Eigen::Matrix3d LidarOptions::R_vehicle_lidar() const {
  return (Eigen::AngleAxisd(radiansFromDegrees(mounting_pitch_deg), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(radiansFromDegrees(mounting_roll_deg), Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

LidarOptions LidarOptions::of(const SensorModel& sensor) {
  LidarOptions options;
  options.sensor = sensor;
  if (sensor.name == "HDL-64E") return options;

  // These stand on a mast rather than behind the edge of a roof.
  options.own_vehicle.setEmpty();
  const auto* sheet = std::find_if(std::begin(kDataSheets), std::end(kDataSheets),
                                   [&](const DataSheet& known) { return sensor.name == known.name; });
  const DataSheet any{"", sensor.columns, 1.0, 120.0, 60.0, 0.015, 3e-3, 360.0};
  const DataSheet& data = sheet == std::end(kDataSheets) ? any : *sheet;
  options.firings_per_turn = data.firings_per_turn;
  options.min_range_m = data.min_range_m;
  options.max_range_m = data.max_range_m;
  options.detection_range_m = data.detection_range_m;
  options.range_noise_m = data.range_noise_m;
  options.beam_divergence_rad = data.beam_divergence_rad;
  options.field_of_view_deg = data.field_of_view_deg;
  return options;
}

LidarOptions LidarOptions::named(const std::string& sensor) { return of(SensorModel::named(sensor)); }

}  // namespace saw_ndt
