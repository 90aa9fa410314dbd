#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "saw_ndt/common/geometry.h"

namespace saw_ndt::internal {

/// Score of a pose and what its first and second derivatives in any parameterization of the pose follow from.
///
/// With the pose x -> R p + t, r = R p, the perturbation is (v, w): x -> exp(w) r + t + v, translation first. Lengths
/// in metres, angles in radians.
struct NdtDerivatives {
  double score = 0.0;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< sum of g, the derivative of the score by the moved point
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();  ///< sum of g r^T
  Matrix6d curvature = Matrix6d::Zero();             ///< sum of J^T (W d2 e C^-1) J: positive semidefinite
  Matrix6d radial_curvature = Matrix6d::Zero();      ///< sum of J^T (W d2^2 e C^-1 q q^T C^-1) J: likewise
  std::size_t pair_count = 0;                        ///< source-voxel pairs that were met

  /// Adds those of other pairs.
  NdtDerivatives& operator+=(const NdtDerivatives& other);

  /// Gradient of the score by (v, w).
  Vector6d gradient() const;
  /// Exact second derivative of the score by (v, w).
  Matrix6d hessian() const;
};

/// Gradient and Hessian in PCL's parameters [x y z roll pitch yaw], R = Rx(roll) Ry(pitch) Rz(yaw) (eq. 6.12 and 6.13
/// of Magnusson 2009).
struct EulerDerivatives {
  double score = 0.0;
  Vector6d gradient = Vector6d::Zero();
  Matrix6d hessian = Matrix6d::Zero();
};

/// @param roll_pitch_yaw  the angles (rad) of the pose at which `derivatives` were taken
EulerDerivatives eulerDerivatives(const NdtDerivatives& derivatives, const Eigen::Vector3d& roll_pitch_yaw);

}  // namespace saw_ndt::internal
