#include "saw_ndt/segmentation/sensor_setup.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "segmentation/labelled_scan.h"

namespace saw_ndt {
namespace {

SensorModel sensor() { return SensorModel::named("OS1-64"); }

/// Above a roof of 4 x 2 m, 0.9 m below the sensor, and the street around it.
Surroundings roofOnStreet(double height_m) {
  return [=, around = street(height_m)](const Eigen::Vector3d& level) {
    constexpr double kToRoof_m = 0.9;
    Hit hit = around(level);
    const Eigen::Vector3d on_roof = level * (-kToRoof_m / level.z());
    if (level.z() < 0.0 && std::abs(on_roof.x()) < 2.0 && std::abs(on_roof.y()) < 1.0) {
      hit.orNearer(on_roof.norm(), 0);
    }
    return hit;
  };
}

/// Expects the mounting as half a degree of each axis and 3 cm of height.
void expectMounting(const LabelledScan& scan, double roll_deg, double pitch_deg, double height_m) {
  SCOPED_TRACE("roll " + std::to_string(roll_deg) + " pitch " + std::to_string(pitch_deg));
  const auto mounting = learnMounting(viewOf(scan.scan));
  ASSERT_TRUE(mounting);
  const Eigen::Vector3d seen = levelFromMounting(mounting->roll_deg, mounting->pitch_deg).row(2);
  const Eigen::Vector3d stated = levelFromMounting(roll_deg, pitch_deg).row(2);
  EXPECT_LT(degreesFromRadians(std::acos(std::min(1.0, seen.dot(stated)))), 0.5);
  EXPECT_NEAR(mounting->height_m, height_m, 0.03);
}

TEST(LearnMounting, FindsAnglesAndHeightWhateverTheyAre) {
  for (const double height_m : {0.6, 1.8, 3.0}) {
    for (const double roll_deg : {-40.0, -20.0, 0.0, 2.0, 30.0, 160.0, 180.0}) {
      for (const double pitch_deg : {-45.0, -20.0, 0.0, 10.0, 45.0}) {
        // It looks for planes that lean by no more than 50 degrees.
        const Eigen::Matrix3d R_level_lidar = levelFromMounting(roll_deg, pitch_deg);
        if (std::abs(R_level_lidar(2, 2)) < std::cos(radiansFromDegrees(48.0))) continue;
        expectMounting(scanOf(sensor(), street(height_m), R_level_lidar), roll_deg, pitch_deg, height_m);
      }
    }
  }
}

TEST(LearnMounting, RollAndPitchAreTheOptions) {
  const auto mounting = learnMounting(viewOf(scanOf(sensor(), street(), levelFromMounting(-30.0, 20.0)).scan));
  ASSERT_TRUE(mounting);
  EXPECT_NEAR(mounting->roll_deg, -30.0, 0.5);
  EXPECT_NEAR(mounting->pitch_deg, 20.0, 0.5);
}

TEST(LearnMounting, ARoofThatIsNearerThanTheGroundIsNone) {
  const SensorModel wide = SensorModel::named("OS0-128");
  for (const double roll_deg : {0.0, 180.0, 15.0}) {
    expectMounting(scanOf(wide, roofOnStreet(2.0), levelFromMounting(roll_deg, 0.0)), roll_deg, 0.0, 2.0);
  }
}

TEST(LearnMounting, TakesTheMedianOfSeveralScans) {
  std::vector<LabelledScan> scans;
  for (const double pitch_deg : {0.0, 3.0, 20.0}) {
    scans.push_back(scanOf(sensor(), street(), levelFromMounting(pitch_deg < 2.0 ? 179.0 : -178.0, pitch_deg)));
  }
  const auto mounting = learnMounting({viewOf(scans[0].scan), viewOf(scans[1].scan), viewOf(scans[2].scan)});
  ASSERT_TRUE(mounting);
  EXPECT_NEAR(mounting->pitch_deg, 3.0, 0.5);
  EXPECT_NEAR(std::abs(mounting->roll_deg), 178.0, 0.5);  // not the mean of 179 and -178
}

TEST(LearnMounting, FindsNothingWhereThereIsNoGround) {
  const LabelledScan ball = scanWithoutBeams([distance = 0.0](const Eigen::Vector3d&) mutable {
    distance = std::fmod(distance + 7.77, 20.0);
    return Hit{2.0 + distance, kWallClass};
  });
  EXPECT_FALSE(learnMounting(viewOf(ball.scan)));
  const LabelledScan walls = scanWithoutBeams([](const Eigen::Vector3d& level) {
    const Hit hit = street()(level);
    return hit.semantic_class == kWallClass ? hit : Hit{};
  });
  EXPECT_GT(walls.scan.points.size(), 10000U);
  EXPECT_FALSE(learnMounting(viewOf(walls.scan)));
  EXPECT_FALSE(learnMounting(ScanView()));
  EXPECT_FALSE(learnMounting(std::vector<ScanView>()));
  LabelledScan few = scanOf(sensor(), street());
  few.scan.points.resize(50);
  EXPECT_FALSE(learnMounting(viewOf(few.scan.points)));
}

TEST(WithMounting, TakesWhatMattersAlone) {
  SegmentationOptions options;
  options.sensor = sensor();
  const auto learned = [&](double roll_deg, const Surroundings& around) {
    const LabelledScan scan = scanOf(options.sensor, around, levelFromMounting(roll_deg, 0.0));
    return withMounting(options, learnMounting(viewOf(scan.scan)).value(), viewOf(scan.scan));
  };
  EXPECT_FALSE(firstDifference(learned(2.0, street()), options));
  const SegmentationOptions leaning = learned(8.0, street());
  EXPECT_NEAR(leaning.mounting_roll_deg, 8.0, 0.5);
  EXPECT_NEAR(leaning.mounting_pitch_deg, 0.0, 0.5);
  EXPECT_EQ(leaning.ground.sensor_height_m, 0.0);  // the segmenter finds it
  options.sensor = SensorModel::named("OS0-128");
  const SegmentationOptions on_roof = learned(0.0, roofOnStreet(2.0));
  EXPECT_EQ(on_roof.mounting_roll_deg, 0.0);
  EXPECT_NEAR(on_roof.ground.sensor_height_m, 2.0, 0.03);
  options.ground.sensor_height_m = 2.1;
  EXPECT_EQ(learned(0.0, roofOnStreet(2.0)).ground.sensor_height_m, 2.1);
}

TEST(WithSlope, SteeperGroundIsLearned) {
  SegmentationOptions options;
  options.sensor = sensor();
  const auto learned = [&](double ramp_deg) {
    const LabelledScan level = scanOf(options.sensor, street()), ramp = scanOf(options.sensor, street(1.8, ramp_deg));
    return withSlope(options, {viewOf(level.scan), viewOf(ramp.scan)}).ground.slope_deg;
  };
  EXPECT_EQ(learned(0.0), 10.0);
  EXPECT_EQ(learned(8.0), 10.0);
  EXPECT_EQ(learned(12.0), 13.0);
  EXPECT_EQ(learned(15.0), 16.0);
}

using Cause = SegmentationDoubt::Cause;

std::vector<Cause> doubtsOf(const LabelledScan& scan, const SegmentationOptions& options) {
  std::vector<Cause> causes;
  for (const SegmentationDoubt& doubt : segmentationDoubts(viewOf(scan.scan), options)) {
    EXPECT_FALSE(doubt.seen.empty());
    EXPECT_NE(doubt.seen.back(), '.');
    causes.push_back(doubt.cause);
  }
  return causes;
}

bool tells(const std::vector<Cause>& doubts, Cause cause) {
  return std::find(doubts.begin(), doubts.end(), cause) != doubts.end();
}

TEST(SegmentationDoubts, ThereAreNoneOfTheRightOptions) {
  for (const char* name : {"OS1-64", "HDL-64E", "VLP-16", "HDL-32E", "OS0-32", "Pandar64"}) {
    SegmentationOptions options;
    options.sensor = SensorModel::named(name);
    const LabelledScan scan = scanOf(options.sensor, street());
    EXPECT_EQ(doubtsOf(scan, options), std::vector<Cause>()) << name;
    EXPECT_EQ(doubtsOf(withoutRings(inFiringOrder(scan)), options), std::vector<Cause>()) << name;
  }
  SegmentationOptions upside_down;
  upside_down.sensor = sensor();
  upside_down.mounting_roll_deg = 180.0;
  EXPECT_EQ(doubtsOf(scanOf(sensor(), street(), levelFromMounting(180.0, 0.0)), upside_down), std::vector<Cause>());
  SegmentationOptions without_beams;
  without_beams.sensor = SensorModel::named("no-rings");
  EXPECT_EQ(doubtsOf(scanWithoutBeams(street()), without_beams), std::vector<Cause>());
}

TEST(SegmentationDoubts, AnotherSensorIsTold) {
  const std::pair<const char*, const char*> wrong[] = {
      {"OS0-128", "OS1-128"}, {"OS0-32", "HDL-64E"}, {"VLP-16", "HDL-64E"}, {"HDL-32E", "VLP-16"}};
  for (const auto& [seen, stated] : wrong) {
    SegmentationOptions options;
    options.sensor = SensorModel::named(stated);
    const LabelledScan scan = withoutRings(inFiringOrder(scanOf(SensorModel::named(seen), street())));
    EXPECT_TRUE(tells(doubtsOf(scan, options), Cause::SENSOR)) << seen << " as " << stated;
  }
}

TEST(SegmentationDoubts, AnotherMountingIsTold) {
  SegmentationOptions options;
  options.sensor = sensor();
  for (const auto& [roll_deg, pitch_deg] : {std::pair(180.0, 0.0), {25.0, 0.0}, {0.0, -25.0}}) {
    const LabelledScan scan = scanOf(sensor(), street(), levelFromMounting(roll_deg, pitch_deg));
    EXPECT_TRUE(tells(doubtsOf(scan, options), Cause::MOUNTING)) << roll_deg << ' ' << pitch_deg;
  }
}

TEST(SegmentationDoubts, PointsInTheFrameOfTheVehicleAreTold) {
  SegmentationOptions options;
  options.sensor = SensorModel::named("HDL-64E");
  LabelledScan scan = scanOf(options.sensor, street());
  for (LidarPoint& point : scan.scan.points) {
    point.x += 0.9F;
    point.z += 1.8F;
  }
  EXPECT_TRUE(tells(doubtsOf(scan, options), Cause::HEIGHT));
}

TEST(SegmentationDoubts, ScansWithoutReturnsAreTold) {
  LabelledScan scan = scanOf(sensor(), street());
  for (LidarPoint& point : scan.scan.points) point = LidarPoint();
  EXPECT_EQ(doubtsOf(scan, {}), std::vector<Cause>{Cause::NO_RETURN});
  EXPECT_EQ(doubtsOf({}, {}), std::vector<Cause>{Cause::NO_RETURN});
}

TEST(SegmentationDoubts, RangesThatLeaveNothingAreTold) {
  SegmentationOptions options;
  options.sensor = sensor();
  options.min_range_m = 99.0;
  EXPECT_FALSE(doubtsOf(scanOf(sensor(), street()), options).empty());
}

}  // namespace
}  // namespace saw_ndt
