#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include "report/segmentation_score.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/segmentation/scan_segmenter.h"
#include "saw_ndt/segmentation/sensor_setup.h"

namespace saw_ndt {

constexpr std::uint16_t kRoadClass = 40;  ///< of SemanticKITTI: ground
constexpr std::uint16_t kWallClass = 50;  ///< building

/// A scan, the SemanticKITTI class of each point and, in its rings, the row of its beam, 0 at the top.
struct LabelledScan {
  ScanPoints scan;
  std::vector<std::uint16_t> classes;
};

/// What a ray from the sensor meets first; infinity: nothing.
struct Hit {
  double range_m = std::numeric_limits<double>::infinity();
  std::uint16_t semantic_class = 0;

  void orNearer(double other_range_m, std::uint16_t other_class) {
    if (other_range_m > 0.0 && other_range_m < range_m) *this = {other_range_m, other_class};
  }
};

/// What stands around a sensor: what a ray meets whose direction is given in level axes.
using Surroundings = std::function<Hit(const Eigen::Vector3d& level)>;

/// A street between two walls, 12 m to either side, that end 6 m above the sensor.
/// @param ramp_deg  from 10 m ahead on the road rises so steeply
inline Surroundings street(double height_m = 1.8, double ramp_deg = 0.0) {
  return [height_m, slope = std::tan(radiansFromDegrees(ramp_deg))](const Eigen::Vector3d& level) {
    constexpr double kRampBegins_m = 10.0, kToWall_m = 12.0, kWallTop_m = 6.0;
    Hit hit;
    const double flat = -height_m / level.z();
    if (level.z() < 0.0 && (slope == 0.0 || flat * level.x() < kRampBegins_m)) hit.orNearer(flat, kRoadClass);
    const double climb = level.z() - slope * level.x();
    if (slope != 0.0 && climb != 0.0) {
      const double ramp = (-height_m - slope * kRampBegins_m) / climb;
      if (ramp * level.x() >= kRampBegins_m) hit.orNearer(ramp, kRoadClass);
    }
    const double wall = kToWall_m / std::abs(level.y());
    if (wall * level.z() < kWallTop_m) hit.orNearer(wall, kWallClass);
    return hit;
  };
}

/// A round hall without a roof in sight: whatever the elevation, a beam has a return.
inline Surroundings hall(double height_m = 1.8, double radius_m = 15.0) {
  return [=](const Eigen::Vector3d& level) {
    Hit hit;
    if (level.z() < 0.0) hit.orNearer(-height_m / level.z(), kRoadClass);
    hit.orNearer(radius_m / level.head<2>().norm(), kWallClass);
    return hit;
  };
}

/// The rotation to level axes by a mounting, as SegmentationOptions has it.
inline Eigen::Matrix3d levelFromMounting(double roll_deg, double pitch_deg) {
  Vector6d xyz_rpy = Vector6d::Zero();
  xyz_rpy(3) = radiansFromDegrees(roll_deg);
  xyz_rpy(4) = radiansFromDegrees(pitch_deg);
  return transformFromXyzRpy(xyz_rpy).linear();
}

/// Adds the return along a direction of the sensor, with a centimetre of noise that is the same in every run.
inline void addReturn(const Surroundings& around, const Eigen::Matrix3d& R_level_lidar,
                      const Eigen::Vector3d& direction, double phase, int row, LabelledScan& result) {
  constexpr double kNearest_m = 0.5, kFarthest_m = 100.0;
  const Hit hit = around(R_level_lidar * direction);
  if (!(hit.range_m > kNearest_m && hit.range_m < kFarthest_m)) return;
  LidarPoint point;
  positionOf(point) = (direction * (hit.range_m + 0.01 * std::sin(phase))).cast<float>();
  point.intensity = 0.5F;
  result.scan.points.push_back(point);
  result.scan.rings.push_back(static_cast<std::uint16_t>(row));
  result.classes.push_back(hit.semantic_class);
}

inline Eigen::Vector3d directionOf(double elevation_rad, double azimuth_rad) {
  return {std::cos(elevation_rad) * std::cos(azimuth_rad), std::cos(elevation_rad) * std::sin(azimuth_rad),
          std::sin(elevation_rad)};
}

/// The scan of a sensor: ring after ring from the top, azimuth rising, without the beams that meet nothing.
/// @param noise_deg  by how much elevations differ from those of the beams at most
inline LabelledScan scanOf(const SensorModel& sensor, const Surroundings& around,
                           const Eigen::Matrix3d& R_level_lidar = Eigen::Matrix3d::Identity(), double noise_deg = 0.0) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> noise(-noise_deg, noise_deg);
  LabelledScan result;
  for (int row = 0; row < sensor.rows(); ++row) {
    const double beam_deg = sensor.elevations_deg[static_cast<std::size_t>(row)];
    for (int column = 0; column < sensor.columns; ++column) {
      const double elevation = radiansFromDegrees(beam_deg + (noise_deg > 0.0 ? noise(random) : 0.0));
      const double azimuth = 2.0 * kPi * (column + 0.5) / sensor.columns;
      addReturn(around, R_level_lidar, directionOf(elevation, azimuth), 12.9898 * column + 78.233 * row, row, result);
    }
  }
  return result;
}

/// The scan of a sensor without beams: directions all around, from -35 to 35 degrees, in no order.
inline LabelledScan scanWithoutBeams(const Surroundings& around, std::size_t rays = 60000,
                                     const Eigen::Matrix3d& R_level_lidar = Eigen::Matrix3d::Identity()) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> azimuth(-kPi, kPi), elevation(radiansFromDegrees(-35), radiansFromDegrees(35));
  LabelledScan result;
  for (std::size_t ray = 0; ray < rays; ++ray) {
    const Eigen::Vector3d direction = directionOf(elevation(random), azimuth(random));
    addReturn(around, R_level_lidar, direction, 12.9898 * static_cast<double>(ray), 0, result);
  }
  result.scan.rings.clear();
  return result;
}

/// The same points in the order of some of their indices.
inline LabelledScan inOrder(const LabelledScan& from, const std::vector<std::size_t>& order) {
  LabelledScan result;
  for (const std::size_t i : order) {
    result.scan.points.push_back(from.scan.points[i]);
    if (!from.scan.rings.empty()) result.scan.rings.push_back(from.scan.rings[i]);
    result.classes.push_back(from.classes[i]);
  }
  return result;
}

/// The same points column after column, clockwise, as most sensors fire.
inline LabelledScan inFiringOrder(const LabelledScan& from) {
  std::vector<std::size_t> order(from.scan.points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<long> columns;
  for (const LidarPoint& point : from.scan.points) columns.push_back(std::lround(-1e4F * std::atan2(point.y, point.x)));
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return columns[a] < columns[b]; });
  return inOrder(from, order);
}

/// The same scan without its rings.
inline LabelledScan withoutRings(LabelledScan from) {
  from.scan.rings.clear();
  return from;
}

/// What the apps learn of scans by themselves.
inline SegmentationOptions learnedOptions(const ScanView& scan, SegmentationOptions options = {}) {
  options.sensor = learnSensor(scan).model;
  if (const auto mounting = learnMounting(scan)) options = withMounting(options, *mounting, scan);
  return withSlope(options, {scan});
}

inline std::vector<StructuralLabel> labelsOf(const ScanView& scan, const SegmentationOptions& options) {
  std::vector<StructuralLabel> labels;
  ScanSegmenter(options).segment(scan, labels);
  return labels;
}

/// How well some options tell the ground of a scan.
inline GroundScore scoreOf(const LabelledScan& labelled, const SegmentationOptions& options) {
  return scoreGround(labelsOf(viewOf(labelled.scan), options), labelled.classes);
}

}  // namespace saw_ndt
