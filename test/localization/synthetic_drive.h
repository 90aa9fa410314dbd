#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <limits>
#include <random>
#include <vector>

#include "saw_ndt/common/geometry.h"
#include "saw_ndt/common/sensor_model.h"
#include "saw_ndt/io/trajectory.h"

namespace saw_ndt {

/// An axis-aligned block that stands in the street (m).
struct Block {
  Eigen::Vector3d low;
  Eigen::Vector3d high;
};

/// Flat ground at z = 0, house walls with a gap on one side, parked cars and poles: every direction is constrained.
inline std::vector<Block> streetBlocks() {
  std::vector<Block> blocks = {{{-30, 8, 0}, {45, 8.5, 9}},    {{-30, -8.5, 0}, {4, -8, 7}},
                               {{12, -8.5, 0}, {45, -8, 7}},   {{45, -9, 0}, {45.5, 9, 8}},
                               {{-30.5, -9, 0}, {-30, 9, 8}},  {{2, 5, 0.2}, {6.2, 6.8, 1.5}},
                               {{-9, 5, 0.2}, {-4.8, 6.8, 2}}, {{14, -6.7, 0.2}, {18, -5, 1.6}}};
  for (const double x : {-18.0, -6.5, 3.0, 9.7, 20.3, 31.0}) {
    blocks.push_back({{x, 7.0, 0}, {x + 0.3, 7.3, 6}});
    blocks.push_back({{x + 4.1, -7.2, 0}, {x + 4.4, -6.9, 5}});
  }
  return blocks;
}

/// Distance (m) along a ray to the ground at z = 0 or the nearest block; infinity where it meets neither.
inline double rangeAmong(const std::vector<Block>& blocks, const Eigen::Vector3d& origin,
                         const Eigen::Vector3d& direction) {
  double nearest = direction.z() < 0.0 ? -origin.z() / direction.z() : std::numeric_limits<double>::infinity();
  const Eigen::Array3d inverse = direction.array().inverse();
  for (const Block& block : blocks) {
    const Eigen::Array3d a = (block.low - origin).array() * inverse, b = (block.high - origin).array() * inverse;
    const double enter = a.min(b).maxCoeff(), leave = a.max(b).minCoeff();
    if (enter > 0.0 && enter <= leave) nearest = std::min(nearest, enter);
  }
  return nearest;
}

/// The scan of a spinning LiDAR on the ground among blocks: ring after ring from the top, azimuth rising, 1 cm of noise
/// along the ray, nothing beyond 70 m. Each point is in the frame that the LiDAR has when it measures it.
/// @param T_ground_lidar_at  pose of the LiDAR at a time from the stamp (s)
/// @param signed_period_s    of a turn, at the stamp along x; negative: clockwise, seen from above; 0: all at once
/// @param times_s            of the points, from the stamp; may be null
template <typename PoseAt>
std::vector<LidarPoint> scanBlocksInMotion(const std::vector<Block>& blocks, const SensorModel& sensor,
                                           const PoseAt& T_ground_lidar_at, double signed_period_s, unsigned seed,
                                           std::vector<double>* times_s = nullptr) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 0.01);
  std::vector<LidarPoint> scan;
  for (const double elevation_deg : sensor.elevations_deg) {
    const double elevation = radiansFromDegrees(elevation_deg);
    for (int column = 0; column < sensor.columns; ++column) {
      const double azimuth = (column + 0.5) * 2.0 * kPi / sensor.columns;
      const Eigen::Vector3d direction(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                      std::sin(elevation));
      const double time_s = signed_period_s * (azimuth < kPi ? azimuth : azimuth - 2.0 * kPi) / (2.0 * kPi);
      const Eigen::Isometry3d T_ground_lidar = T_ground_lidar_at(time_s);
      const double range =
          rangeAmong(blocks, T_ground_lidar.translation(), T_ground_lidar.linear() * direction) + noise(random);
      if (!(range < 70.0)) continue;
      LidarPoint point;
      positionOf(point) = (direction * range).cast<float>();
      point.intensity = 0.5F;
      scan.push_back(point);
      if (times_s != nullptr) times_s->push_back(time_s);
    }
  }
  return scan;
}

/// The same of a LiDAR that stands.
inline std::vector<LidarPoint> scanBlocks(const std::vector<Block>& blocks, const SensorModel& sensor,
                                          const Eigen::Isometry3d& T_ground_lidar, unsigned seed) {
  return scanBlocksInMotion(
      blocks, sensor, [&](double) { return T_ground_lidar; }, 0.0, seed);
}

/// A drive and its scans.
struct SyntheticDrive {
  std::vector<double> stamps_s;
  std::vector<Eigen::Isometry3d> T_map_lidar;  ///< the map is the frame of the first scan
  std::vector<std::vector<LidarPoint>> scans;
  std::vector<std::vector<double>> times_s;  ///< of the points, from the stamp; empty: all at once
};

/// The scans of even numbers, whose points are all measured at once.
inline SyntheticDrive evenScansOf(const SyntheticDrive& drive) {
  SyntheticDrive even;
  for (std::size_t scan = 0; scan < drive.scans.size(); scan += 2) {
    even.stamps_s.push_back(drive.stamps_s[scan]);
    even.T_map_lidar.push_back(drive.T_map_lidar[scan]);
    even.scans.push_back(drive.scans[scan]);
  }
  return even;
}

/// A drive down the street on a circle of 50 m radius, 5 m/s and ten scans a second.
inline SyntheticDrive driveDownTheStreet(const SensorModel& sensor, int scan_count) {
  constexpr double kRadius_m = 50.0, kSpeed_mps = 5.0, kSensorHeight_m = 1.73;
  const auto pose = [&](double stamp_s) {
    const double yaw = kSpeed_mps * stamp_s / kRadius_m;
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() << -5.0 + kRadius_m * std::sin(yaw), -2.0 + kRadius_m * (1.0 - std::cos(yaw)), kSensorHeight_m;
    T.linear() = rotationFromVector({0.0, 0.0, yaw});
    return T;
  };
  const std::vector<Block> street = streetBlocks();
  SyntheticDrive drive;
  for (int i = 0; i < scan_count; ++i) {
    drive.stamps_s.push_back(0.1 * i);
    drive.T_map_lidar.push_back(pose(0.0).inverse() * pose(0.1 * i));
    drive.scans.push_back(scanBlocks(street, sensor, pose(0.1 * i), static_cast<unsigned>(i)));
  }
  return drive;
}

/// A faster drive down the same street, a bend of 60 m radius, of a LiDAR that turns ten times a second.
/// @param signed_period_s  as scanBlocksInMotion(): 0.1, -0.1, or 0 for scans without skew
inline SyntheticDrive raceDownTheStreet(const SensorModel& sensor, int scan_count, double speed_mps,
                                        double signed_period_s, unsigned seed) {
  constexpr double kRadius_m = 60.0, kSensorHeight_m = 1.73;
  const auto pose = [&](double at_s) {
    const double yaw = speed_mps * at_s / kRadius_m;
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() << -20.0 + kRadius_m * std::sin(yaw), -3.0 + kRadius_m * (1.0 - std::cos(yaw)), kSensorHeight_m;
    T.linear() = rotationFromVector({0.0, 0.0, yaw});
    return T;
  };
  const std::vector<Block> street = streetBlocks();
  SyntheticDrive drive;
  for (int i = 0; i < scan_count; ++i) {
    const double stamp_s = 0.1 * i;
    drive.stamps_s.push_back(stamp_s);
    drive.T_map_lidar.push_back(pose(0.0).inverse() * pose(stamp_s));
    drive.times_s.emplace_back();
    drive.scans.push_back(scanBlocksInMotion(
        street, sensor, [&](double time_s) { return pose(stamp_s + time_s); }, signed_period_s,
        seed + static_cast<unsigned>(i), &drive.times_s.back()));
  }
  return drive;
}

/// LiDAR to left camera, as that of KITTI: x right, y down, z forward, and a lever arm.
inline Eigen::Isometry3d syntheticCalibration() {
  Eigen::Isometry3d Tr = Eigen::Isometry3d::Identity();
  Tr.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  Tr.translation() << 0.05, -0.08, -0.27;
  return Tr;
}

/// Writes a drive in KITTI layout: velodyne/, poses.txt, calib.txt and times.txt.
inline void writeKittiDrive(const std::filesystem::path& folder, const SyntheticDrive& drive) {
  std::filesystem::create_directories(folder / "velodyne");
  std::vector<Eigen::Isometry3d> camera_poses;
  std::ofstream times(folder / "times.txt");
  for (std::size_t i = 0; i < drive.scans.size(); ++i) {
    std::ostringstream name;
    name << std::setfill('0') << std::setw(6) << i << ".bin";
    std::ofstream bin(folder / "velodyne" / name.str(), std::ios::binary);
    for (const LidarPoint& point : drive.scans[i]) {
      const float values[4] = {point.x, point.y, point.z, point.intensity};
      bin.write(reinterpret_cast<const char*>(values), sizeof values);
    }
    times << drive.stamps_s[i] << '\n';
    camera_poses.push_back(cameraPose(drive.T_map_lidar[i], syntheticCalibration()));
  }
  writeKittiTrajectory(folder / "poses.txt", camera_poses);
  writeKittiTrajectory(folder / "calib.txt", {syntheticCalibration()});
  std::ostringstream calibration;
  calibration << "Tr: " << std::ifstream(folder / "calib.txt").rdbuf();
  std::ofstream(folder / "calib.txt") << calibration.str();
}

}  // namespace saw_ndt
