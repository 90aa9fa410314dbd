#include "saw_ndt/segmentation/segmentation_options.h"

#include <gtest/gtest.h>

#include <cmath>

#include "expect_throws.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

template <typename Change>
void expectDifference(const Change& change, const std::string& field, const std::string& first,
                      const std::string& second) {
  SegmentationOptions changed;
  change(changed);
  const auto difference = firstDifference(SegmentationOptions(), changed);
  ASSERT_TRUE(difference) << field;
  EXPECT_EQ(difference->field, field);
  EXPECT_EQ(difference->first, first);
  EXPECT_EQ(difference->second, second);
}

TEST(FirstDifference, NamesTheFieldAndBothValues) {
  using Options = SegmentationOptions;
  EXPECT_FALSE(firstDifference(Options(), Options()));
  expectDifference([](Options& o) { o.sensor = SensorModel::named("VLP-16"); }, "sensor.name", "HDL-64E", "VLP-16");
  expectDifference([](Options& o) { o.sensor.columns = 900; }, "sensor.columns", "1800", "900");
  expectDifference([](Options& o) { o.mounting_pitch_deg = -1.5; }, "mounting_pitch_deg", "0", "-1.5");
  expectDifference([](Options& o) { o.ground.rule = GroundRule::INCLINATION; }, "ground.rule", "growing",
                   "inclination");
  expectDifference([](Options& o) { o.ground.inclination_limit_deg = 9; }, "ground.inclination_limit_deg", "10", "9");
  expectDifference([](Options& o) { o.ground.inclination_top_elevation_deg = 1; },
                   "ground.inclination_top_elevation_deg", "-2", "1");
  expectDifference([](Options& o) { o.ground.sensor_height_m = 1.73; }, "ground.sensor_height_m", "0", "1.73");
  expectDifference([](Options& o) { o.ground.slope_deg = 8.5; }, "ground.slope_deg", "10", "8.5");
  expectDifference([](Options& o) { o.ground.step_tolerance_m = 0.1; }, "ground.step_tolerance_m", "0.08", "0.1");
  expectDifference([](Options& o) { o.ground.profile_tolerance_m = 1; }, "ground.profile_tolerance_m", "0.12", "1");
  expectDifference([](Options& o) { o.ground.foot_angle_deg = 45; }, "ground.foot_angle_deg", "20", "45");
  expectDifference([](Options& o) { o.ground.foot_height_m = 0; }, "ground.foot_height_m", "0.1", "0");
  expectDifference([](Options& o) { o.ground.smooths = false; }, "ground.smooths", "true", "false");
  expectDifference([](Options& o) { o.components.connection_angle_deg = 50; }, "components.connection_angle_deg", "60",
                   "50");
  expectDifference([](Options& o) { o.components.min_points = 1; }, "components.min_points", "30", "1");
  expectDifference([](Options& o) { o.components.min_points_tall = 1; }, "components.min_points_tall", "5", "1");
  expectDifference([](Options& o) { o.components.min_rings_tall = 1; }, "components.min_rings_tall", "3", "1");
}

TEST(FirstDifference, SeesTheLastBitOfAnElevation) {
  SegmentationOptions first, second;
  first.sensor.elevations_deg = {1.0, -1.0};
  second.sensor.elevations_deg = {1.0, std::nextafter(-1.0, 0.0)};
  const auto difference = firstDifference(first, second);
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->field, "sensor.elevations_deg");
  EXPECT_EQ(difference->first, "1 -1");
  EXPECT_EQ(difference->second, "1 -0.9999999999999999");
}

TEST(SegmentationOptions, ASensorsNameIsALine) {
  SegmentationOptions options;
  options.sensor.name = "a\nb";
  expectThrows<std::invalid_argument>([&] { options.check(); }, {"name = a"});
}

}  // namespace
}  // namespace saw_ndt
