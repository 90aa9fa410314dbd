#include "segmentation/ground_detection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "saw_ndt/segmentation/scan_segmenter.h"
#include "segmentation/synthetic_scan.h"

namespace saw_ndt {
namespace {

// One degree between rows, half a degree between columns; row 6 looks level ahead.
SensorModel testSensor() { return SensorModel::evenlySpaced("test", 32, 720, 6.0, -25.0); }

SegmentationOptions testOptions(GroundRule rule) {
  SegmentationOptions options;
  options.sensor = testSensor();
  options.ground.rule = rule;
  return options;
}

TEST(GroundDetection, GroundGoesOnBehindAnObstacleAndUphill) {
  const SensorModel sensor = testSensor();
  const double slope = std::tan(radiansFromDegrees(4.0));
  const auto range_at = [&](int row, int column) {
    if (row >= 17 && row <= 18) return kNoReturn;  // two rings without returns
    const double elevation = radiansFromDegrees(sensor.elevations_deg[row]);
    if (column < 60 && row <= 20 && row >= 19) return 6.0 / std::cos(elevation) - 0.2;  // low box
    const double level = kSensorHeight / (slope - std::tan(elevation));
    return level > 0.0 && level < 50.0 ? level / std::cos(elevation) : kNoReturn;
  };
  ScanSegmenter segmenter(testOptions(GroundRule::GROWING));
  std::vector<StructuralLabel> labels;
  segmenter.segment(viewOf(organizedScan(sensor, range_at)), labels);
  for (int row = 0; row < sensor.rows(); ++row) {
    for (int column = 70; column < 700; ++column) {
      if (!std::isfinite(range_at(row, column))) continue;
      ASSERT_EQ(labels[row * sensor.columns + column], StructuralLabel::GROUND) << row << " " << column;
    }
    for (int column = 5; column < 55; ++column) {
      if (row >= 17 || !std::isfinite(range_at(row, column))) continue;
      ASSERT_EQ(labels[row * sensor.columns + column], StructuralLabel::GROUND) << row << " " << column;
    }
  }
}

// Beams so dense that a wall 8 m away is met every 6 cm.
SensorModel denseSensor() { return SensorModel::evenlySpaced("dense", 64, 720, 2.0, -25.0); }

struct RingOfLabels {
  bool is_ground;  ///< of the scene
  StructuralLabel label;
};

// What a segmenter makes of a scene that is the same all around: flat ground, and something upright from a height above
// the ground on at a distance.
std::vector<RingOfLabels> labelsOfRings(const GroundOptions& ground, double distance, double first_height) {
  const SensorModel sensor = denseSensor();
  const auto upright_begins = [&](int row) {
    return kSensorHeight + distance * std::tan(radiansFromDegrees(sensor.elevations_deg[row])) >= first_height;
  };
  const auto range_at = [&](int row, int) {
    if (!upright_begins(row)) return rangeToFlatGround(sensor, row);
    return distance / std::cos(radiansFromDegrees(sensor.elevations_deg[row]));
  };
  SegmentationOptions options;
  options.sensor = sensor;
  options.ground = ground;
  ScanSegmenter segmenter(options);
  std::vector<StructuralLabel> labels;
  segmenter.segment(viewOf(organizedScan(sensor, range_at)), labels);
  std::vector<RingOfLabels> rings;
  for (int row = 0; row < sensor.rows(); ++row) {
    const auto first = labels.begin() + static_cast<std::ptrdiff_t>(row) * sensor.columns;
    EXPECT_EQ(std::count(first, first + sensor.columns, *first), sensor.columns) << row;
    rings.push_back({!upright_begins(row), *first});
  }
  return rings;
}

// Rings of the scene's ground, or of what stands on it, that are labelled as ground.
std::ptrdiff_t labelledGround(const std::vector<RingOfLabels>& rings, bool is_ground) {
  return std::count_if(rings.begin(), rings.end(), [&](const RingOfLabels& ring) {
    return ring.is_ground == is_ground && ring.label == StructuralLabel::GROUND;
  });
}

std::ptrdiff_t groundRings(const std::vector<RingOfLabels>& rings) {
  return std::count_if(rings.begin(), rings.end(), [](const RingOfLabels& ring) { return ring.is_ground; });
}

TEST(GroundDetection, TheFootOfAWallIsNoGround) {
  // 2 cm before where the beam of a row would meet the ground: the wall's lowest returns are 0 and 6 cm high.
  const double distance =
      rangeToFlatGround(denseSensor(), 33) * std::cos(radiansFromDegrees(denseSensor().elevations_deg[33])) - 0.02;
  const auto rings = labelsOfRings({}, distance, 0.0);
  EXPECT_EQ(labelledGround(rings, false), 0);
  EXPECT_EQ(labelledGround(rings, true), groundRings(rings));

  GroundOptions without_feet;
  without_feet.foot_angle_deg = 90.0;
  EXPECT_EQ(labelledGround(labelsOfRings(without_feet, distance, 0.0), false), 2);
}

TEST(GroundDetection, GroundBeneathAVehicleStays) {
  // The body begins 0.3 m above the ground; beams meet the ground up to 1.4 m behind its side.
  const auto rings = labelsOfRings({}, 7.0, 0.3);
  EXPECT_EQ(labelledGround(rings, false), 0);
  EXPECT_EQ(labelledGround(rings, true), groundRings(rings));

  GroundOptions of_any_height;
  of_any_height.foot_height_m = 1.0;
  EXPECT_LT(labelledGround(labelsOfRings(of_any_height, 7.0, 0.3), true), groundRings(rings));
}

TEST(GroundDetection, EveryOtherColumnMayBeEmpty) {
  const SensorModel sensor = testSensor();
  for (const int parity : {0, 1}) {
    const auto scan = organizedScan(sensor, [&](int row, int column) {
      return column % 2 == parity ? kNoReturn : rangeToFlatGround(sensor, row, 40.0);
    });
    ScanSegmenter segmenter(testOptions(GroundRule::GROWING));
    std::vector<StructuralLabel> labels;
    segmenter.segment(viewOf(scan), labels);
    for (std::size_t i = 0; i < labels.size(); ++i) {
      ASSERT_EQ(labels[i], std::isfinite(scan[i].x) ? StructuralLabel::GROUND : StructuralLabel::NOISE) << i;
    }
  }
}

TEST(GroundDetection, MountingPitchIsTakenOut) {
  for (const GroundRule rule : {GroundRule::INCLINATION, GroundRule::GROWING}) {
    const SensorModel sensor = testSensor();
    SegmentationOptions options = testOptions(rule);
    options.mounting_pitch_deg = 15.0;
    options.ground.inclination_top_elevation_deg = 6.0;
    const double pitch = radiansFromDegrees(options.mounting_pitch_deg);
    const auto range_at = [&](int row, int column) {
      const double elevation = radiansFromDegrees(sensor.elevations_deg[row]);
      const double azimuth = (column + 0.5) * 2.0 * kPi / sensor.columns;
      const double down =
          std::sin(pitch) * std::cos(elevation) * std::cos(azimuth) - std::cos(pitch) * std::sin(elevation);
      return down > 0.05 ? kSensorHeight / down : kNoReturn;
    };
    const auto scan = organizedScan(sensor, range_at);
    ScanSegmenter segmenter(options);
    std::vector<StructuralLabel> labels;
    segmenter.segment(viewOf(scan), labels);
    std::size_t returns = 0;
    for (const auto& point : scan) returns += std::isfinite(point.x) ? 1U : 0U;
    const auto ground = static_cast<double>(std::count(labels.begin(), labels.end(), StructuralLabel::GROUND));
    EXPECT_GT(ground, 0.99 * static_cast<double>(returns));
  }
}

}  // namespace
}  // namespace saw_ndt
