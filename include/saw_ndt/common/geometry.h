#pragma once

#include <Eigen/Geometry>

#include "saw_ndt/common/scan_view.h"

namespace saw_ndt {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr double kPi = 3.14159265358979323846;

constexpr double radiansFromDegrees(double degrees) { return degrees * (kPi / 180.0); }
constexpr double degreesFromRadians(double radians) { return radians * (180.0 / kPi); }

/// The position of a point (m), to read and to set.
inline Eigen::Map<Eigen::Vector3f> positionOf(LidarPoint& point) { return Eigen::Map<Eigen::Vector3f>(&point.x); }
inline Eigen::Map<const Eigen::Vector3f> positionOf(const LidarPoint& point) {
  return Eigen::Map<const Eigen::Vector3f>(&point.x);
}

/// The angle, in radians, wrapped to (-pi, pi].
double wrappedAngle(double angle);

/// The cross-product matrix of v: skewSymmetric(v) * w == v.cross(w).
Eigen::Matrix3d skewSymmetric(const Eigen::Vector3d& v);

/// The transform with its rotation replaced by the nearest rotation matrix. Products of many poses drift away from
/// orthonormality, and `T1 * T2.inverse() * T1` multiplies that drift: normalize what such a product returns.
Eigen::Isometry3d normalizedRotation(const Eigen::Isometry3d& T);

/// Throws std::invalid_argument that names the transform unless it is finite and its rotation is one to within 1e-6.
void requireRigid(const Eigen::Isometry3d& T, const char* name);

/// The rotation whose axis times angle (rad) is `rotation_vector`.
Eigen::Matrix3d rotationFromVector(const Eigen::Vector3d& rotation_vector);

/// The inverse of rotationFromVector(), of length 0 to pi.
Eigen::Vector3d rotationVector(const Eigen::Matrix3d& R);

/// The J for which a body that moves at v (m/s, own frame) and turns at w (rad/s) for t seconds comes to J(w t) v t.
Eigen::Matrix3d meanRotation(const Eigen::Vector3d& rotation_vector);

/// The angle of a rotation in radians, 0 to pi; exact for small angles too.
double rotationAngle(const Eigen::Matrix3d& R);

/// Yaw in radians: the direction of the body's x axis in the horizontal plane of the parent frame.
double heading(const Eigen::Isometry3d& T);

/// The transform that translation (m) and roll, pitch, yaw (rad; R = Rz(yaw) Ry(pitch) Rx(roll)) state.
Eigen::Isometry3d transformFromXyzRpy(const Vector6d& xyz_rpy);

/// The inverse of transformFromXyzRpy(): x y z roll pitch yaw.
Vector6d xyzRpyFromTransform(const Eigen::Isometry3d& T);

}  // namespace saw_ndt
