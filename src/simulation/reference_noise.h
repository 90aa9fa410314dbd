#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "simulation/vehicle_motion.h"

namespace saw_ndt {

/// The slowly changing error of a reference trajectory by GNSS and INS.
struct ReferenceNoiseOptions {
  double position_sigma_m = 0.02;         ///< standard deviation of x and of y, each; 0: no error at all
  double height_sigma_ratio = 1.5;        ///< standard deviation of z over that of x
  double rotation_sigma_deg_per_m = 0.3;  ///< standard deviation of roll, pitch and yaw (deg), over that of x (m)
  double correlation_time_s = 30.0;       ///< in which an error loses all but 1/e of itself
  std::uint64_t seed = 1;

  /// @throws std::invalid_argument that names the field
  void check() const;
};

/// The poses of a motion as the reference states them.
///
/// Each of the six errors is a first-order Gauss-Markov (Ornstein-Uhlenbeck) process in its stationary state:
/// e(t + dt) = a e(t) + sigma sqrt(1 - a^2) n with a = exp(-dt / correlation_time) and n of the standard normal
/// distribution, which is exact for any dt. Positions err along the axes of the scene, rotations about those of the
/// LiDAR. @throws std::invalid_argument for wrong options, or a motion without one pose a stamp or with falling stamps
std::vector<Eigen::Isometry3d> withReferenceNoise(const VehicleMotion& motion, const ReferenceNoiseOptions& options);

}  // namespace saw_ndt
