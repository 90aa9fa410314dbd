#include "saw_ndt/common/geometry.h"

#include <Eigen/SVD>
#include <cmath>
#include <stdexcept>
#include <string>

namespace saw_ndt {

template <int kEigenMaxAlignBytes>
const int EigenAlignment<kEigenMaxAlignBytes>::must_be_that_of_the_saw_ndt_library = kEigenMaxAlignBytes;
template struct EigenAlignment<EIGEN_MAX_ALIGN_BYTES>;

double wrappedAngle(double angle) {
  const double wrapped = std::remainder(angle, 2.0 * kPi);
  return wrapped <= -kPi ? wrapped + 2.0 * kPi : wrapped;
}

Eigen::Matrix3d skewSymmetric(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

Eigen::Isometry3d normalizedRotation(const Eigen::Isometry3d& T) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(T.linear(), Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if (u.determinant() * svd.matrixV().determinant() < 0.0) u.col(2) *= -1.0;
  Eigen::Isometry3d normalized = T;
  normalized.linear() = u * svd.matrixV().transpose();
  return normalized;
}

void requireRigid(const Eigen::Isometry3d& T, const char* name) {
  const Eigen::Matrix3d R = T.linear();
  if (T.matrix().allFinite() && R.isUnitary(1e-6) && R.determinant() > 0.0) return;
  throw std::invalid_argument(std::string(name) + ": must be a finite rigid transform");
}

Eigen::Matrix3d rotationFromVector(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  if (angle < 1e-12) return Eigen::Matrix3d::Identity() + skewSymmetric(rotation_vector);
  return Eigen::AngleAxisd(angle, rotation_vector / angle).toRotationMatrix();
}

Eigen::Vector3d rotationVector(const Eigen::Matrix3d& R) {
  const Eigen::AngleAxisd turn(R);
  return turn.axis() * turn.angle();
}

Eigen::Matrix3d meanRotation(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  const Eigen::Matrix3d K = skewSymmetric(rotation_vector);
  // Up to here the terms left out are less than 1e-13; beyond, the quotients below keep their digits.
  if (angle < 1e-4) return Eigen::Matrix3d::Identity() + 0.5 * K + K * K / 6.0;
  const double squared = angle * angle;
  const double sine_of_half = std::sin(0.5 * angle);
  return Eigen::Matrix3d::Identity() + 2.0 * sine_of_half * sine_of_half / squared * K +
         (angle - std::sin(angle)) / (squared * angle) * K * K;
}

double rotationAngle(const Eigen::Matrix3d& R) {
  const Eigen::Vector3d axis(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  return std::atan2(axis.norm(), R.trace() - 1.0);
}

double heading(const Eigen::Isometry3d& T) { return std::atan2(T.linear()(1, 0), T.linear()(0, 0)); }

Eigen::Isometry3d transformFromXyzRpy(const Vector6d& xyz_rpy) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = xyz_rpy.head<3>();
  T.linear() = (Eigen::AngleAxisd(xyz_rpy[5], Eigen::Vector3d::UnitZ()) *
                Eigen::AngleAxisd(xyz_rpy[4], Eigen::Vector3d::UnitY()) *
                Eigen::AngleAxisd(xyz_rpy[3], Eigen::Vector3d::UnitX()))
                   .toRotationMatrix();
  return T;
}

Vector6d xyzRpyFromTransform(const Eigen::Isometry3d& T) {
  const Eigen::Matrix3d& R = T.linear();
  Vector6d xyz_rpy;
  xyz_rpy << T.translation(), std::atan2(R(2, 1), R(2, 2)), std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0))),
      std::atan2(R(1, 0), R(0, 0));
  return xyz_rpy;
}

Eigen::Matrix3d rotationFromEuler(const Eigen::Vector3d& roll_pitch_yaw) {
  return (Eigen::AngleAxisd(roll_pitch_yaw.x(), Eigen::Vector3d::UnitX()) *
          Eigen::AngleAxisd(roll_pitch_yaw.y(), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(roll_pitch_yaw.z(), Eigen::Vector3d::UnitZ()))
      .toRotationMatrix();
}

Eigen::Vector3d eulerFromRotation(const Eigen::Matrix3d& R) {
  return {std::atan2(-R(1, 2), R(2, 2)), std::atan2(R(0, 2), std::hypot(R(0, 0), R(0, 1))),
          std::atan2(-R(0, 1), R(0, 0))};
}

}  // namespace saw_ndt
