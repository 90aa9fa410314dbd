#include "simulation/lidar_options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "expect_throws.h"

namespace saw_ndt {
namespace {

TEST(LidarOptions, EverySensorModelWithBeamsHasValidOnes) {
  const LidarOptions of_none = LidarOptions::of(SensorModel::evenlySpaced("none", 4, 700, 3.0, -6.0));
  EXPECT_NO_THROW(of_none.check());
  EXPECT_EQ(of_none.firings_per_turn, 700);
  for (const std::string& name : SensorModel::names()) {
    const LidarOptions options = LidarOptions::named(name);
    EXPECT_EQ(options.sensor.name, name);
    if (options.sensor.rows() == 0) {
      expectThrows<std::invalid_argument>([&] { options.check(); }, {"sensor = " + name, "with beams"});
      continue;
    }
    EXPECT_NO_THROW(options.check()) << name;
    EXPECT_GE(options.firings_per_turn, options.sensor.columns) << name;
    EXPECT_LE(options.firings_per_turn, 1.21 * options.sensor.columns) << name;
    EXPECT_LE(options.detection_range_m, options.max_range_m) << name;
    EXPECT_NE(options.detection_range_m, of_none.detection_range_m) << name << " has no data sheet";
    EXPECT_EQ(options.field_of_view_deg, name == "AT128" ? 120.0 : 360.0) << name;
  }
  EXPECT_EQ(LidarOptions::named("VLP-16").firings_per_turn, 1800);
  EXPECT_EQ(LidarOptions::named("OS-64").firings_per_turn, 1024);
  expectThrows<std::invalid_argument>([] { LidarOptions::named("HDL-65"); }, {"HDL-65", "VLP-16"});
}

TEST(LidarOptions, MountingTurnsTheLidarAboutItsAxes) {
  LidarOptions options;
  EXPECT_EQ(options.R_vehicle_lidar(), Eigen::Matrix3d::Identity());
  options.mounting_pitch_deg = 30.0;
  EXPECT_NEAR((options.R_vehicle_lidar() * Eigen::Vector3d::UnitX()).z(), -0.5, 1e-12);
  options.mounting_pitch_deg = 0.0;
  options.mounting_roll_deg = 30.0;
  EXPECT_NEAR((options.R_vehicle_lidar() * Eigen::Vector3d::UnitY()).z(), 0.5, 1e-12);
  options.mounting_pitch_deg = 30.0;
  options.mounting_roll_deg = 180.0;
  EXPECT_NEAR((options.R_vehicle_lidar() * Eigen::Vector3d::UnitX()).z(), -0.5, 1e-12);
  EXPECT_NEAR((options.R_vehicle_lidar() * Eigen::Vector3d::UnitZ()).z(), -std::sqrt(0.75), 1e-12);
}

TEST(LidarOptions, ErrorsNameTheField) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto expectNamed = [](double LidarOptions::*field, double value, const char* name) {
    LidarOptions options;
    options.*field = value;
    expectThrows<std::invalid_argument>([&] { options.check(); }, {std::string(name) + " = "});
  };
  expectNamed(&LidarOptions::scan_period_s, 0.0, "scan_period_s");
  expectNamed(&LidarOptions::min_range_m, 0.0, "min_range_m");
  expectNamed(&LidarOptions::max_range_m, 0.5, "max_range_m");
  expectNamed(&LidarOptions::range_noise_m, -0.1, "range_noise_m");
  expectNamed(&LidarOptions::beam_range_offset_m, nan, "beam_range_offset_m");
  expectNamed(&LidarOptions::angle_jitter_rad, -1.0, "angle_jitter_rad");
  expectNamed(&LidarOptions::beam_divergence_rad, nan, "beam_divergence_rad");
  expectNamed(&LidarOptions::pulse_length_m, -1.0, "pulse_length_m");
  expectNamed(&LidarOptions::edge_step_m, 0.0, "edge_step_m");
  expectNamed(&LidarOptions::detection_range_m, 0.0, "detection_range_m");
  expectNamed(&LidarOptions::power_fluctuation, -1.0, "power_fluctuation");
  expectNamed(&LidarOptions::surface_roughness_rad, nan, "surface_roughness_rad");
  expectNamed(&LidarOptions::dropout_share, 1.1, "dropout_share");
  expectNamed(&LidarOptions::field_of_view_deg, 0.0, "field_of_view_deg");
  expectNamed(&LidarOptions::field_of_view_deg, 361.0, "field_of_view_deg");
  expectNamed(&LidarOptions::mounting_roll_deg, 181.0, "mounting_roll_deg");
  expectNamed(&LidarOptions::mounting_pitch_deg, nan, "mounting_pitch_deg");
  expectNamed(&LidarOptions::rain_share, -0.1, "rain_share");
  expectNamed(&LidarOptions::rain_mean_range_m, 0.0, "rain_mean_range_m");

  LidarOptions options;
  options.firings_per_turn = 7;
  expectThrows<std::invalid_argument>([&] { options.check(); }, {"firings_per_turn = 7"});
  options = LidarOptions();
  options.own_vehicle.max().z() = 1.0F;
  expectThrows<std::invalid_argument>([&] { options.check(); }, {"own_vehicle"});
}

}  // namespace
}  // namespace saw_ndt
