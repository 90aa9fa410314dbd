#include "registration/ndt_derivatives.h"

#include <Eigen/Geometry>
#include <cmath>

namespace saw_ndt::internal {

NdtDerivatives& NdtDerivatives::operator+=(const NdtDerivatives& other) {
  score += other.score;
  force += other.force;
  moment += other.moment;
  curvature += other.curvature;
  radial_curvature += other.radial_curvature;
  pair_count += other.pair_count;
  return *this;
}

Vector6d NdtDerivatives::gradient() const {
  Vector6d gradient;
  gradient << force, moment(2, 1) - moment(1, 2), moment(0, 2) - moment(2, 0), moment(1, 0) - moment(0, 1);
  return gradient;
}

Matrix6d NdtDerivatives::hessian() const {
  Matrix6d hessian = radial_curvature - curvature;
  // Second order of exp(w) r: sum of g . (w x (w x r)) / 2.
  hessian.bottomRightCorner<3, 3>() +=
      0.5 * (moment + moment.transpose()) - moment.trace() * Eigen::Matrix3d::Identity();
  return hessian;
}

EulerDerivatives eulerDerivatives(const NdtDerivatives& derivatives, const Eigen::Vector3d& roll_pitch_yaw) {
  // Each angle turns the rotated point about one axis, given here in the target frame.
  const Eigen::Matrix3d Rx = rotationFromEuler({roll_pitch_yaw.x(), 0.0, 0.0});
  const Eigen::Matrix3d Rxy = rotationFromEuler({roll_pitch_yaw.x(), roll_pitch_yaw.y(), 0.0});
  Eigen::Matrix3d axes;
  axes << Eigen::Vector3d::UnitX(), Rx * Eigen::Vector3d::UnitY(), Rxy * Eigen::Vector3d::UnitZ();
  Matrix6d by_angles = Matrix6d::Identity();
  by_angles.bottomRightCorner<3, 3>() = axes;

  EulerDerivatives euler;
  euler.score = derivatives.score;
  euler.gradient = by_angles.transpose() * derivatives.gradient();
  euler.hessian = by_angles.transpose() * (derivatives.radial_curvature - derivatives.curvature) * by_angles;
  for (int outer = 0; outer < 3; ++outer) {
    for (int inner = outer; inner < 3; ++inner) {
      // sum of g . (a x (b x r)), a the axis of the outer rotation
      const Eigen::Vector3d a = axes.col(outer), b = axes.col(inner);
      const double second = b.dot(derivatives.moment * a) - derivatives.moment.trace() * a.dot(b);
      euler.hessian(3 + outer, 3 + inner) += second;
      if (inner != outer) euler.hessian(3 + inner, 3 + outer) += second;
    }
  }
  return euler;
}

}  // namespace saw_ndt::internal
