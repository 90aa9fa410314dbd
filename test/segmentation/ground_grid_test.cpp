#include "segmentation/ground_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "segmentation/labelled_scan.h"
#include "segmentation/segmentation_stages.h"

namespace saw_ndt {
namespace {

SegmentationOptions withoutBeams() {
  SegmentationOptions options;
  options.sensor = SensorModel::named("no-rings");
  return options;
}

double shareOf(const std::vector<StructuralLabel>& labels, StructuralLabel label) {
  return static_cast<double>(std::count(labels.begin(), labels.end(), label)) / static_cast<double>(labels.size());
}

/// Level ground up to 40 m around a sensor.
Hit flatGround(const Eigen::Vector3d& level) {
  const double range_m = -1.8 / level.z();
  return range_m > 0.0 && range_m < 40.0 ? Hit{range_m, kRoadClass} : Hit{};
}

TEST(GroundGrid, FlatGroundIsGround) {
  const LabelledScan scan = scanWithoutBeams(flatGround);
  const auto labels = labelsOf(viewOf(scan.scan), withoutBeams());
  ASSERT_EQ(labels.size(), scan.scan.points.size());
  EXPECT_GT(shareOf(labels, StructuralLabel::GROUND), 0.999);
}

TEST(GroundGrid, WallsAreToldFromGround) {
  const LabelledScan scan = scanWithoutBeams(street());
  const GroundScore score = scoreOf(scan, withoutBeams());
  EXPECT_GT(score.f1(), 0.985);
  EXPECT_LT(score.noiseShare(), 0.002);
}

TEST(GroundGrid, SlopesAreGround) {
  for (const double ramp_deg : {5.0, 8.0}) {
    const LabelledScan scan = scanWithoutBeams(street(1.8, ramp_deg));
    const GroundScore score = scoreOf(scan, withoutBeams());
    EXPECT_GT(score.f1(), 0.985) << ramp_deg;
    EXPECT_LT(score.noiseShare(), 0.002) << ramp_deg;
  }
}

TEST(GroundGrid, GroundGoesOnBehindAKerbAndALowWallIsNone) {
  // A step of the ground at 5 m to the left, behind which it goes on.
  const auto step = [](double step_m) {
    return [step_m](const Eigen::Vector3d& level) {
      constexpr double kToStep_m = 5.0, kHeight_m = 1.8;
      Hit hit;
      const double low = -kHeight_m / level.z(), high = (step_m - kHeight_m) / level.z();
      if (low > 0.0 && low < 40.0 && low * level.y() < kToStep_m) hit.orNearer(low, kRoadClass);
      if (high > 0.0 && high < 40.0 && high * level.y() >= kToStep_m) hit.orNearer(high, kRoadClass);
      const double riser = kToStep_m / level.y();
      const double above = riser * level.z() + kHeight_m;
      if (riser > 0.0 && above > 0.0 && above < step_m) hit.orNearer(riser, kWallClass);
      return hit;
    };
  };
  const LabelledScan kerb = scanWithoutBeams(step(0.12), 200000);
  const GroundScore of_kerb = scoreOf(kerb, withoutBeams());
  EXPECT_GT(of_kerb.recall(), 0.99);

  const LabelledScan wall = scanWithoutBeams(step(0.6), 200000);
  const auto labels = labelsOf(viewOf(wall.scan), withoutBeams());
  double of_wall = 0.0, as_ground = 0.0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    // What of it is within the roughness of the ground before it is told by nothing.
    if (wall.classes[i] != kWallClass || wall.scan.points[i].z < -1.8F + 0.25F) continue;
    of_wall += 1.0;
    as_ground += labels[i] == StructuralLabel::GROUND ? 1.0 : 0.0;
  }
  EXPECT_GT(of_wall, 500.0);
  EXPECT_LT(as_ground, 0.03 * of_wall);
}

TEST(GroundGrid, APostIsKeptAndALonePointIsNoise) {
  LabelledScan scan = scanWithoutBeams(flatGround);
  const std::size_t ground = scan.scan.points.size();
  for (int i = 0; i < 10; ++i) {
    LidarPoint on_post;
    positionOf(on_post) << 8.0F, 3.0F, -1.2F + 0.1F * static_cast<float>(i);
    scan.scan.points.push_back(on_post);
  }
  LidarPoint alone;
  positionOf(alone) << -8.0F, -3.0F, 1.0F;
  scan.scan.points.push_back(alone);
  const auto labels = labelsOf(viewOf(scan.scan), withoutBeams());
  EXPECT_EQ(std::count(labels.begin() + static_cast<std::ptrdiff_t>(ground), labels.end(), StructuralLabel::NON_GROUND),
            10);
  EXPECT_EQ(labels.back(), StructuralLabel::NOISE);
}

TEST(GroundGrid, WhatIsNoReturnIsNoiseAndChangesNothing) {
  LabelledScan scan = scanWithoutBeams(street());
  const auto expected = labelsOf(viewOf(scan.scan), withoutBeams());
  const auto size = static_cast<std::ptrdiff_t>(expected.size());
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  const Eigen::Vector3f none[] = {{kNan, 1, -1},     {1, kNan, -1},      {1, 2, kNan},
                                  {kInfinity, 0, 0}, {0, -kInfinity, 0}, {3, 1, -kInfinity},
                                  {0, 0, 0},         {1e30F, 1, 1},      {300, 0, -1.8F}};
  for (const Eigen::Vector3f& position : none) {
    LidarPoint point;
    positionOf(point) = position;
    scan.scan.points.push_back(point);
  }
  const auto labels = labelsOf(viewOf(scan.scan), withoutBeams());
  ASSERT_EQ(labels.size(), scan.scan.points.size());
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), labels.begin()));
  EXPECT_EQ(std::count(labels.begin() + size, labels.end(), StructuralLabel::NOISE), std::ptrdiff_t{std::size(none)});
}

TEST(GroundGrid, NothingOfAnEarlierScanStays) {
  const LabelledScan scan = scanWithoutBeams(street());
  const auto expected = labelsOf(viewOf(scan.scan), withoutBeams());
  ScanSegmenter segmenter(withoutBeams());
  std::vector<StructuralLabel> labels(7);
  segmenter.segment(ScanView(), labels);
  EXPECT_TRUE(labels.empty());
  segmenter.segment(viewOf(scanWithoutBeams(hall(), 5000).scan), labels);
  segmenter.segment(viewOf(scan.scan), labels, 3);
  EXPECT_EQ(labels, expected);
}

TEST(GroundGrid, ASensorOnItsSideIsSegmentedOnTheGrid) {
  // Its beams fan out from straight down to straight up on either side.
  const SensorModel sensor = SensorModel::named("OS0-128");
  for (const double roll_deg : {90.0, -90.0}) {
    const LabelledScan scan = scanOf(sensor, street(), levelFromMounting(roll_deg, 0.0));
    SegmentationOptions options;
    options.sensor = sensor;
    options.mounting_roll_deg = roll_deg;
    ScanSegmenter segmenter(options);
    std::vector<StructuralLabel> labels;
    segmenter.segment(viewOf(scan.scan), labels);
    EXPECT_TRUE(segmenter.stages().on_grid);
    const GroundScore score = scoreGround(labels, scan.classes);
    EXPECT_GT(score.f1(), 0.99);
    EXPECT_LT(score.noiseShare(), 0.005);
  }
}

}  // namespace
}  // namespace saw_ndt
