#pragma once

#include <Eigen/Geometry>
#include <vector>

namespace saw_ndt {

/// How a vehicle with a LiDAR drives through a scene: one pose a scan.
struct VehicleMotion {
  std::vector<double> stamps_s;                  ///< middle of each scan, increasing
  std::vector<Eigen::Isometry3d> T_scene_lidar;  ///< pose of the LiDAR at the stamp

  int scanCount() const { return static_cast<int>(stamps_s.size()); }
  /// The pose at a time: between two stamps, or beyond the first and last one by no more than a scan, at constant
  /// velocity and turn rate as seen from the LiDAR. @throws std::invalid_argument that names the stamp: farther beyond,
  /// less than two scans, stamps that do not increase
  Eigen::Isometry3d poseAt(double stamp_s) const;
  /// The same drive with the LiDAR turned in its place; see LidarOptions::R_vehicle_lidar().
  VehicleMotion withMounting(const Eigen::Matrix3d& R_vehicle_lidar) const;
};

}  // namespace saw_ndt
