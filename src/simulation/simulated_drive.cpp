#include "simulation/simulated_drive.h"

#include "saw_ndt/common/error.h"
#include "simulation/scene_builder.h"
#include "simulation/vehicle_driving.h"

namespace saw_ndt {
namespace {

template <typename Drive>
SimulatedDrive makeDrive(const SceneDescription& description, const DriveOptions& options, Route route, Drive drive) {
  SimulatedDrive result;
  result.route = std::make_shared<const Route>(std::move(route));
  result.terrain = std::make_shared<const Terrain>(*result.route, description, options.seed);
  result.motion = std::make_shared<const VehicleMotion>(drive(*result.route, *result.terrain));
  result.scene = buildScene(description, result.route, result.terrain, result.motion, options);
  return result;
}

}  // namespace

SimulatedDrive driveCourse(const SceneDescription& description, const DriveOptions& options, double scan_period_s,
                           int scans) {
  options.check();
  return makeDrive(description, options, Route::fromCourse(description, options.seed),
                   [&](const Route& route, const Terrain& terrain) {
                     return driveRoute(route, terrain, description, options, scan_period_s, scans);
                   });
}

SimulatedDrive driveTrajectory(const SceneDescription& description, const DriveOptions& options,
                               const std::vector<Eigen::Isometry3d>& T_scene_lidar, const std::vector<double>& stamps_s,
                               int scans) {
  options.check();
  checkOption(scans >= 0, "scans", scans, "0 or greater");
  std::vector<Eigen::Vector3d> ground;
  for (const Eigen::Isometry3d& T : T_scene_lidar) {
    ground.emplace_back(T.translation() - Eigen::Vector3d(0.0, 0.0, kLidarHeight_m));
  }
  return makeDrive(description, options, Route::throughPositions(ground), [&](const Route&, const Terrain& terrain) {
    VehicleMotion motion = followTrajectory(T_scene_lidar, stamps_s, terrain, options);
    if (scans > 0 && scans < motion.scanCount()) {
      motion.stamps_s.resize(static_cast<std::size_t>(scans));
      motion.T_scene_lidar.resize(static_cast<std::size_t>(scans));
    }
    return motion;
  });
}

}  // namespace saw_ndt
