#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

namespace saw_ndt::internal {

/// What a GPS/IMU record (oxts) of KITTI's raw data states of the pose of the IMU.
struct OxtsRecord {
  double latitude_deg = 0.0, longitude_deg = 0.0, altitude_m = 0.0;
  double roll = 0.0, pitch = 0.0, yaw = 0.0;  ///< rad; x forward, y left, z up; yaw 0 is east, counterclockwise
};

/// The records of a file, one a line of 30 numbers. Throws Error that names the line.
std::vector<OxtsRecord> readOxts(const std::filesystem::path& path);

/// Poses of the IMU in the frame of the first one, by KITTI's Mercator projection, whose scale is that of the first
/// latitude (Geiger et al., Vision meets Robotics: The KITTI Dataset, IJRR 2013).
std::vector<Eigen::Isometry3d> imuPoses(const std::vector<OxtsRecord>& records);

/// A rigid transform of KITTI's raw data (calib_imu_to_velo.txt, calib_velo_to_cam.txt), from its lines `R` and `T`.
/// Throws Error that names what is missing or wrong.
Eigen::Isometry3d readKittiRawTransform(const std::filesystem::path& path);

}  // namespace saw_ndt::internal
