#pragma once

#include <vector>

#include "simulation/drive_options.h"
#include "simulation/route.h"
#include "simulation/scene_description.h"
#include "simulation/terrain.h"
#include "simulation/vehicle_motion.h"

namespace saw_ndt {

/// Height of the LiDAR above the ground (m), as on KITTI's car.
constexpr double kLidarHeight_m = 1.73;

/// The motion of a vehicle that drives a route from its start to its end, slower in bends, the body swaying a little.
/// @param scan_period_s  from scan to scan
/// @param scans          at most so many scans; 0: to the end of the route
VehicleMotion driveRoute(const Route& route, const Terrain& terrain, const SceneDescription& description,
                         const DriveOptions& options, double scan_period_s, int scans);

/// The motion of a vehicle that repeats a recorded one: x, y and heading as recorded (drives other than the first:
/// moved within the lane and in time), height and inclination as the ground has them.
/// @param T_scene_lidar  recorded poses of the LiDAR, one at each stamp
/// @throws std::invalid_argument unless there are at least two, as many as stamps, and stamps increase
VehicleMotion followTrajectory(const std::vector<Eigen::Isometry3d>& T_scene_lidar, const std::vector<double>& stamps_s,
                               const Terrain& terrain, const DriveOptions& options);

}  // namespace saw_ndt
