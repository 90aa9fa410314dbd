#include "simulation/lidar_options.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "expect_throws.h"

namespace saw_ndt {
namespace {

TEST(LidarOptions, EverySensorModelHasValidOnes) {
  for (const std::string& name : SensorModel::names()) {
    const LidarOptions options = LidarOptions::named(name);
    EXPECT_NO_THROW(options.check()) << name;
    EXPECT_EQ(options.sensor.name, name);
  }
  EXPECT_EQ(LidarOptions::named("VLP-16").firings_per_turn, 1800);
  EXPECT_EQ(LidarOptions::named("OS-64").firings_per_turn, 1024);
  expectThrows<std::invalid_argument>([] { LidarOptions::named("HDL-65"); }, {"HDL-65", "VLP-16"});
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
