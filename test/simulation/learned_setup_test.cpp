#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "segmentation/labelled_scan.h"
#include "simulation/lidar_simulator.h"
#include "simulation/short_drive.h"

namespace saw_ndt {
namespace {

/// What a LiDAR sees on a residential street, with exact labels.
LabelledScan streetSeenBy(const LidarOptions& lidar) {
  constexpr int kScan = 10;
  static const SimulatedDrive drive = [] {
    SceneDescription description = shortScene("residential");
    description.course.resize(1);
    return driveCourse(description, {}, 0.1, kScan + 1);
  }();
  LidarSimulator simulator(drive.scene, lidar);
  const LidarScan seen = simulator.scan(drive.motion->withMounting(lidar.R_vehicle_lidar()), kScan);
  LabelledScan scan;
  scan.scan.points = seen.points;
  scan.scan.rings = seen.rings;
  scan.classes = seen.semantic_classes;
  return scan;
}

class SimulatedSensor : public ::testing::TestWithParam<std::string> {};

TEST_P(SimulatedSensor, GroundIsToldByLearnedOptionsAsByItsName) {
  const LabelledScan scan = streetSeenBy(LidarOptions::named(GetParam()));
  SegmentationOptions named;
  named.sensor = SensorModel::named(GetParam());
  const double f1 = scoreOf(scan, named).f1();
  EXPECT_GT(f1, 0.97);
  EXPECT_NEAR(scoreOf(scan, learnedOptions(viewOf(scan.scan))).f1(), f1, 0.01);
  // As a driver that tells nothing of the beams may give it. Without rings the beams of two of these sensors, a tenth
  // of a degree apart, are no longer told apart, and the grid around the sensor is segmented.
  const LabelledScan bare = withoutRings(inFiringOrder(scan));
  const SegmentationOptions learned = learnedOptions(viewOf(bare.scan));
  EXPECT_NEAR(scoreOf(bare, learned).f1(), f1, learned.sensor.rows() > 0 ? 0.01 : 0.02);
  EXPECT_EQ(learned.sensor.rows() == 0, GetParam() == "RS-128" || GetParam() == "VLS-128");
}

std::vector<std::string> sensorsWithBeams() {
  std::vector<std::string> names;
  for (const std::string& name : SensorModel::names()) {
    if (SensorModel::named(name).rows() > 0) names.push_back(name);
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(Sensors, SimulatedSensor, ::testing::ValuesIn(sensorsWithBeams()),
                         [](const ::testing::TestParamInfo<std::string>& tested) {
                           std::string name = tested.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(SimulatedMounting, GroundIsToldByLearnedOptionsAsUpright) {
  LidarOptions lidar = LidarOptions::named("OS1-64");
  SegmentationOptions upright;
  upright.sensor = lidar.sensor;
  const double f1 = scoreOf(streetSeenBy(lidar), upright).f1();
  for (const auto& [roll_deg, pitch_deg] : {std::pair(180.0, 0.0), {20.0, 0.0}, {0.0, 20.0}}) {
    lidar.mounting_roll_deg = roll_deg;
    lidar.mounting_pitch_deg = pitch_deg;
    const LabelledScan scan = streetSeenBy(lidar);
    EXPECT_NEAR(scoreOf(scan, learnedOptions(viewOf(scan.scan))).f1(), f1, 0.01) << roll_deg << ' ' << pitch_deg;
  }
}

}  // namespace
}  // namespace saw_ndt
