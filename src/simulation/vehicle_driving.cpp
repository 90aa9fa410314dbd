#include "simulation/vehicle_driving.h"

#include <algorithm>
#include <cmath>

#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "simulation/lattice_noise.h"

namespace saw_ndt {
namespace {

constexpr double kHalfWheelbase_m = 1.35, kHalfTrack_m = 0.8;
constexpr double kSway_deg = 0.15;  // one sigma, of pitch and roll
constexpr double kSwayPeriod_s = 0.7;
constexpr double kWander_m = 0.08;  // one sigma, from the middle of the way
constexpr double kWanderLength_m = 40.0;
constexpr double kGreatestShift_m = 0.5;  // of a drive from the middle of the lane
constexpr double kAcceleration_mps2 = 1.5;

/// How one drive's vehicle keeps to the way.
class Driver {
 public:
  explicit Driver(const DriveOptions& options)
      : wander_(mixedSeed(options.seed, options.drive, 501), kWanderLength_m),
        sway_(mixedSeed(options.seed, options.drive, 502), kSwayPeriod_s) {
    SceneRandom random(mixedSeed(options.seed, options.drive, 500));
    time_shift_ = random.uniform(0.0, 1.0);
    shift_m_ = random.uniform(0.4, 1.0) * kGreatestShift_m * (random.chance(0.5) ? 1.0 : -1.0);
    speed_factor_ = random.uniform(0.95, 1.05);
    if (options.drive == 1) time_shift_ = shift_m_ = 0.0, speed_factor_ = 1.0;
  }

  double lateral(double distance_m) const { return shift_m_ + kWander_m * wander_({distance_m, 0.0}); }
  double timeShift() const { return time_shift_; }
  double speedFactor() const { return speed_factor_; }

  /// The pose of the LiDAR of a vehicle that stands on the ground, its body swayed as it is at that time.
  Eigen::Isometry3d poseOnGround(const Terrain& terrain, const Eigen::Vector2d& position, double heading,
                                 double stamp_s) const {
    const Eigen::Rotation2Dd rotation(heading);
    const auto wheel = [&](double x, double y) {
      return terrain.height(position + rotation * Eigen::Vector2d(x * kHalfWheelbase_m, y * kHalfTrack_m));
    };
    const double front_left = wheel(1, 1), front_right = wheel(1, -1), rear_left = wheel(-1, 1),
                 rear_right = wheel(-1, -1);
    const double sway = radiansFromDegrees(kSway_deg);
    const double pitch = -std::atan2(front_left + front_right - rear_left - rear_right, 4.0 * kHalfWheelbase_m) +
                         sway * sway_({stamp_s, 0.0});
    const double roll = std::atan2(front_left + rear_left - front_right - rear_right, 4.0 * kHalfTrack_m) +
                        sway * sway_({stamp_s, 100.0});
    Vector6d xyz_rpy;
    xyz_rpy << position, (front_left + front_right + rear_left + rear_right) / 4.0, roll, pitch, heading;
    return transformFromXyzRpy(xyz_rpy) * Eigen::Translation3d(0.0, 0.0, kLidarHeight_m);
  }

 private:
  LatticeNoise wander_, sway_;
  double time_shift_ = 0.0;  ///< share of a scan's period
  double shift_m_ = 0.0;
  double speed_factor_ = 1.0;
};

/// Greatest speed at each station: that of bends, reached and left at a comfortable acceleration.
std::vector<double> speedLimits(const Route& route, double speed_mps, double lateral_acceleration_mps2) {
  const auto& stations = route.stations();
  std::vector<double> limits(stations.size(), speed_mps);
  for (std::size_t i = 2; i + 2 < stations.size(); ++i) {
    const Eigen::Vector2d &before = stations[i - 2].direction, &after = stations[i + 2].direction;
    const double turn = std::abs(std::atan2(before.x() * after.y() - before.y() * after.x(), before.dot(after)));
    const double curvature = turn / (4.0 * Route::kStationSpacing_m);
    if (curvature > 1e-6) limits[i] = std::min(limits[i], std::sqrt(lateral_acceleration_mps2 / curvature));
  }
  const auto reachable = [](double from_mps) {
    return std::sqrt(from_mps * from_mps + 2.0 * kAcceleration_mps2 * Route::kStationSpacing_m);
  };
  for (std::size_t i = 1; i < limits.size(); ++i) limits[i] = std::min(limits[i], reachable(limits[i - 1]));
  for (std::size_t i = limits.size() - 1; i-- > 0;) limits[i] = std::min(limits[i], reachable(limits[i + 1]));
  return limits;
}

}  // namespace

VehicleMotion driveRoute(const Route& route, const Terrain& terrain, const SceneDescription& description,
                         const DriveOptions& options, double scan_period_s, int scans) {
  checkOption(scan_period_s > 0.0, "scan_period_s", scan_period_s, "greater than 0");
  checkOption(scans >= 0, "scans", scans, "0 or greater");
  const Driver driver(options);
  const std::vector<double> limits =
      speedLimits(route, driver.speedFactor() * description.speed_mps, description.lateral_acceleration_mps2);
  VehicleMotion motion;
  double distance_m = driver.timeShift() * scan_period_s * limits.front();
  while (distance_m < route.length_m() && (scans == 0 || motion.scanCount() < scans)) {
    const RouteStation station = route.at(distance_m);
    const double stamp_s = scan_period_s * motion.scanCount();
    motion.stamps_s.push_back(stamp_s);
    motion.T_scene_lidar.push_back(
        driver.poseOnGround(terrain, station.position.head<2>() + driver.lateral(distance_m) * station.left(),
                            std::atan2(station.direction.y(), station.direction.x()), stamp_s));
    distance_m += scan_period_s * limits[std::min(limits.size() - 1, static_cast<std::size_t>(distance_m))];
  }
  return motion;
}

VehicleMotion followTrajectory(const std::vector<Eigen::Isometry3d>& T_scene_lidar, const std::vector<double>& stamps_s,
                               const Terrain& terrain, const DriveOptions& options) {
  checkOption(T_scene_lidar.size() >= 2, "poses", T_scene_lidar.size(), "at least two");
  checkOption(T_scene_lidar.size() == stamps_s.size(), "stamps", stamps_s.size(), "one for each pose");
  for (std::size_t i = 1; i < stamps_s.size(); ++i) {
    checkOption(stamps_s[i] > stamps_s[i - 1], "stamp", stamps_s[i], "later than the one before it");
  }
  const Driver driver(options);
  const VehicleMotion recorded{stamps_s, T_scene_lidar};
  VehicleMotion motion;
  double distance_m = 0.0;
  for (std::size_t i = 0; i < stamps_s.size(); ++i) {
    const std::size_t next = std::min(i + 1, stamps_s.size() - 1);
    const double shift_s = driver.timeShift() * (stamps_s[next] - stamps_s[next - 1]);
    const Eigen::Isometry3d T = recorded.poseAt(stamps_s[i] + shift_s);
    const double yaw = heading(T);
    const Eigen::Vector2d left(-std::sin(yaw), std::cos(yaw));
    if (i > 0) distance_m += (T_scene_lidar[i].translation() - T_scene_lidar[i - 1].translation()).norm();
    motion.stamps_s.push_back(stamps_s[i]);
    motion.T_scene_lidar.push_back(
        driver.poseOnGround(terrain, T.translation().head<2>() + driver.lateral(distance_m) * left, yaw, stamps_s[i]));
  }
  return motion;
}

}  // namespace saw_ndt
