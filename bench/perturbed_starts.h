#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "saw_ndt/common/geometry.h"

namespace saw_ndt {

/// How many starts around a pose there are.
constexpr int kPerturbedStartCount = 10;

/// Start k of them, 0 <= k < kPerturbedStartCount: 0.5 m off in direction k, up, level or down by 0.1 m, turned by one
/// degree to either side.
inline Eigen::Isometry3d perturbedStart(const Eigen::Isometry3d& T_reference, int k) {
  const double direction = 2.0 * kPi * k / kPerturbedStartCount;
  Eigen::Isometry3d T = T_reference;
  T.translation() += Eigen::Vector3d(0.5 * std::cos(direction), 0.5 * std::sin(direction), 0.1 * (k % 3 - 1));
  const double yaw = radiansFromDegrees(k % 2 == 1 ? 1.0 : -1.0);
  T.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * T.linear();
  return T;
}

}  // namespace saw_ndt
