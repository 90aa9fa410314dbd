#pragma once

#include <memory>
#include <vector>

#include "simulation/drive_options.h"
#include "simulation/route.h"
#include "simulation/scene.h"
#include "simulation/scene_description.h"
#include "simulation/terrain.h"
#include "simulation/vehicle_motion.h"

namespace saw_ndt {

/// A drive ready to be seen by a LiDAR, and what it was made of.
struct SimulatedDrive {
  std::shared_ptr<const Route> route;
  std::shared_ptr<const Terrain> terrain;
  std::shared_ptr<const VehicleMotion> motion;
  Scene scene;
};

/// A drive along the course of a scene.
/// @param scans  at most so many, 0: to the end of the course
/// @throws std::invalid_argument that names what is wrong
SimulatedDrive driveCourse(const SceneDescription& description, const DriveOptions& options, double scan_period_s,
                           int scans);

/// A drive along recorded poses, the scene laid along all of them; see followTrajectory().
/// @param scans  at most so many, 0: all
/// @throws std::invalid_argument that names what is wrong
SimulatedDrive driveTrajectory(const SceneDescription& description, const DriveOptions& options,
                               const std::vector<Eigen::Isometry3d>& T_scene_lidar, const std::vector<double>& stamps_s,
                               int scans);

}  // namespace saw_ndt
