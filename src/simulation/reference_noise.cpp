#include "simulation/reference_noise.h"

#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <stdexcept>

#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "simulation/random_engine.h"

namespace saw_ndt {

void ReferenceNoiseOptions::check() const {
  const auto checkNotNegative = [](double value, const char* name) {
    checkOption(value >= 0.0 && std::isfinite(value), name, value, "0 or more");
  };
  checkNotNegative(position_sigma_m, "position_sigma_m");
  checkNotNegative(height_sigma_ratio, "height_sigma_ratio");
  checkNotNegative(rotation_sigma_deg_per_m, "rotation_sigma_deg_per_m");
  checkOption(correlation_time_s > 0.0 && std::isfinite(correlation_time_s), "correlation_time_s", correlation_time_s,
              "positive");
}

std::vector<Eigen::Isometry3d> withReferenceNoise(const VehicleMotion& motion, const ReferenceNoiseOptions& options) {
  options.check();
  if (motion.T_scene_lidar.size() != motion.stamps_s.size()) {
    throw std::invalid_argument("motion: must have one pose a stamp");
  }
  if (options.position_sigma_m == 0.0) return motion.T_scene_lidar;

  const double rotation_sigma_rad = radiansFromDegrees(options.rotation_sigma_deg_per_m * options.position_sigma_m);
  Vector6d sigma;
  sigma << options.position_sigma_m, options.position_sigma_m, options.height_sigma_ratio * options.position_sigma_m,
      Eigen::Vector3d::Constant(rotation_sigma_rad);
  RandomEngine random = seededEngine({options.seed});
  boost::random::normal_distribution<double> normal;
  Vector6d error = Vector6d::Zero();
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t i = 0; i < motion.stamps_s.size(); ++i) {
    // Nothing is left of what was long ago: the first error is one of the stationary state.
    double left = 0.0;
    if (i > 0) {
      const double elapsed_s = motion.stamps_s[i] - motion.stamps_s[i - 1];
      if (!(elapsed_s >= 0.0)) throw std::invalid_argument("stamps_s: must increase");
      left = std::exp(-elapsed_s / options.correlation_time_s);
    }
    for (int axis = 0; axis < 6; ++axis) {
      error[axis] = left * error[axis] + std::sqrt(1.0 - left * left) * sigma[axis] * normal(random);
    }
    Eigen::Isometry3d T = motion.T_scene_lidar[i];
    T.translation() += error.head<3>();
    T.linear() = T.linear() * rotationFromVector(error.tail<3>());
    poses.push_back(T);
  }
  return poses;
}

}  // namespace saw_ndt
