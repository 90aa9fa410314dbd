#include "map/map_metadata.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "saw_ndt/common/sensor_model.h"

namespace saw_ndt {

using namespace internal;

namespace {

using internal::MetadataFault;
using internal::metadataText;
using internal::readMetadata;

MapOrigin originWith(const SegmentationOptions& segmentation) {
  MapOrigin origin;
  origin.software_version = "3.2.1";
  origin.segmentation = segmentation;
  return origin;
}

/// Options of which no field has its default value; doubles that no short decimal number is.
SegmentationOptions unusualOptions() {
  SegmentationOptions options;
  options.sensor = {"Sensor = \"7\" of Zürich ", 777, {1.0 / 3.0, 0.1 + 0.2, -5e-324, -1e-300, -77.7}};
  options.mounting_pitch_deg = 2.0 / 3.0;
  options.mounting_roll_deg = -100.0 / 3.0;
  options.min_range_m = 0.3;
  options.max_range_m = 1e2 / 3.0;
  options.vehicle_box_m = {-1.1, -0.7, -2.2, 1.0 / 3.0, 0.7, 0.1};
  options.ground.rule = GroundRule::INCLINATION;
  options.ground.inclination_limit_deg = 10.1;
  options.ground.inclination_top_elevation_deg = -2.2;
  options.ground.sensor_height_m = 1.0 / 7.0;
  options.ground.slope_deg = 8.3;
  options.ground.step_tolerance_m = 0.07;
  options.ground.profile_tolerance_m = 0.16;
  options.ground.foot_angle_deg = 31.5;
  options.ground.foot_height_m = 0.11;
  options.ground.smooths = false;
  options.components = {61.5, 31, 6, 4};
  return options;
}

void expectFault(const std::string& text, std::size_t offset, const std::string& reason) {
  MapOrigin origin;
  const auto fault = readMetadata(text, origin);
  ASSERT_TRUE(fault) << text;
  EXPECT_EQ(fault->offset, offset) << text;
  EXPECT_NE(fault->reason.find(reason), std::string::npos) << fault->reason;
  EXPECT_FALSE(origin.segmentation);
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

TEST(MapMetadata, EveryFieldComesBackBitForBit) {
  for (const SegmentationOptions& options : {SegmentationOptions(), unusualOptions()}) {
    MapOrigin read;
    ASSERT_FALSE(readMetadata(metadataText(originWith(options)), read));
    EXPECT_EQ(read.software_version, "3.2.1");
    ASSERT_TRUE(read.segmentation);
    EXPECT_EQ(read.segmentation->sensor.name, options.sensor.name);
    EXPECT_EQ(read.segmentation->sensor.elevations_deg, options.sensor.elevations_deg);
    EXPECT_EQ(read.segmentation->mounting_pitch_deg, options.mounting_pitch_deg);
    EXPECT_EQ(read.segmentation->ground.smooths, options.ground.smooths);
    EXPECT_EQ(read.segmentation->components.min_rings_tall, options.components.min_rings_tall);
    EXPECT_FALSE(firstDifference(*read.segmentation, options));
  }
}

TEST(MapMetadata, IsTextOfKeysAndValues) {
  MapOrigin origin;
  EXPECT_EQ(metadataText(origin), "software_version = \nsegmentation = none\n");
  const std::string text = metadataText(originWith({}));
  EXPECT_EQ(text.rfind("software_version = 3.2.1\nsegmentation = known\nsensor.name = HDL-64E\n", 0), 0U) << text;
  EXPECT_NE(
      text.find("\nground.step_tolerance_m = 0.08\nground.profile_tolerance_m = 0.12\nground.foot_angle_deg = 20\n"
                "ground.foot_height_m = 0.1\nground.smooths = true\n"),
      std::string::npos)
      << text;
  EXPECT_EQ(text.back(), '\n');
}

TEST(MapMetadata, UnknownKeysArePassedOver) {
  MapOrigin origin;
  const std::string text = metadataText(originWith({}));
  EXPECT_FALSE(readMetadata("later = 1\n" + text + "ground.later = a = b\n", origin));
  EXPECT_TRUE(origin.segmentation);
}

TEST(MapMetadata, BeforeThereWereFeetNothingWasAFoot) {
  SegmentationOptions options;
  std::string text = metadataText(originWith(options));
  for (const char* line : {"ground.foot_angle_deg = 20\n", "ground.foot_height_m = 0.1\n"})
    text = replaced(text, line, "");
  MapOrigin read;
  ASSERT_FALSE(readMetadata(text, read));
  ASSERT_TRUE(read.segmentation);
  options.ground.foot_angle_deg = 90.0;
  EXPECT_FALSE(firstDifference(*read.segmentation, options));
}

TEST(MapMetadata, BeforeThereWereRangesAllReturnsOfUprightSensorsCounted) {
  std::string text = metadataText(originWith({}));
  for (const char* line : {"mounting_roll_deg = 0\n", "min_range_m = 0\n", "max_range_m = inf\n", "vehicle_box_m = \n"})
    text = replaced(text, line, "");
  MapOrigin read;
  ASSERT_FALSE(readMetadata(text, read));
  ASSERT_TRUE(read.segmentation);
  EXPECT_FALSE(firstDifference(*read.segmentation, SegmentationOptions()));
}

TEST(MapMetadata, AMissingOrMalformedKeyIsNamedWithItsPlace) {
  const std::string text = metadataText(originWith({}));
  // Keys that files of earlier versions do not have.
  const std::vector<std::string> may_lack = {"ground.foot_angle_deg", "ground.foot_height_m", "mounting_roll_deg",
                                             "min_range_m",           "max_range_m",          "vehicle_box_m"};
  expectFault("", 0, "software_version");
  expectFault("software_version = 1\n", 0, "segmentation");
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = text.find('\n', start) + 1;
    const std::string key = text.substr(start, text.find(" = ", start) - start);
    if (std::find(may_lack.begin(), may_lack.end(), key) == may_lack.end()) {
      expectFault(text.substr(0, start) + text.substr(end), 0, "does not give " + key);
    }
    expectFault(text + text.substr(start, end - start), text.size(), key + " twice");
    start = end;
  }
  const auto valueOf = [&](const std::string& key) { return text.find("\n" + key + " = ") + key.size() + 4; };
  const auto expectMalformed = [&](const std::string& key, const std::string& value, const std::string& by) {
    expectFault(replaced(text, key + " = " + value, key + " = " + by), valueOf(key), key);
  };
  expectMalformed("segmentation", "known", "unknown");
  expectMalformed("sensor.columns", "1800", "1800.5");
  expectMalformed("sensor.columns", "1800", "");
  expectMalformed("sensor.columns", "1800", "99999999999999");
  expectMalformed("sensor.elevations_deg", "2.45 2.08", "2.45  2.08");
  expectMalformed("ground.slope_deg", "10", "10 ");
  expectMalformed("ground.slope_deg", "10", "ten");
  expectMalformed("ground.rule", "growing", "Growing");
  expectMalformed("ground.smooths", "true", "1");
  expectFault(text.substr(0, text.size() - 1), text.rfind('\n', text.size() - 2) + 1, "not `key = value`");
  expectFault("\n" + text, 0, "not `key = value`");
  expectFault(replaced(text, "ground.slope_deg = 10", "ground.slope_deg = 80"), 0, "slope_deg = 80");
}

}  // namespace
}  // namespace saw_ndt
