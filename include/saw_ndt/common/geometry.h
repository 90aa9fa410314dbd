#pragma once

#include <Eigen/Geometry>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/scan_view.h"

namespace saw_ndt {

/// Eigen aligns its types, and allocates them, by the vector instructions that the compiler is told to use: a program
/// that is compiled with -march=native or -mavx does not understand those of a library that is compiled without. Every
/// file that includes this header refers to the symbol of its own alignment. The library has the symbol of its own
/// alone, so that such a program does not link instead of computing rubbish.
template <int kEigenMaxAlignBytes>
struct SAW_NDT_EXPORT EigenAlignment {
  static const int must_be_that_of_the_saw_ndt_library;
};
extern template struct EigenAlignment<EIGEN_MAX_ALIGN_BYTES>;
namespace {
[[maybe_unused, gnu::used]] const int* const eigen_alignment_of_this_file =
    &EigenAlignment<EIGEN_MAX_ALIGN_BYTES>::must_be_that_of_the_saw_ndt_library;
}  // namespace

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr double kPi = 3.14159265358979323846;

constexpr double radiansFromDegrees(double degrees) { return degrees * (kPi / 180.0); }
constexpr double degreesFromRadians(double radians) { return radians * (180.0 / kPi); }

/// Where the body (the LiDAR, unless stated otherwise) was at a moment.
struct StampedPose {
  double stamp_s = 0.0;
  Eigen::Isometry3d T_map_body = Eigen::Isometry3d::Identity();
};

/// The position of a point (m), to read and to set.
inline Eigen::Map<Eigen::Vector3f> positionOf(LidarPoint& point) { return Eigen::Map<Eigen::Vector3f>(&point.x); }
inline Eigen::Map<const Eigen::Vector3f> positionOf(const LidarPoint& point) {
  return Eigen::Map<const Eigen::Vector3f>(&point.x);
}

/// The angle, in radians, wrapped to (-pi, pi].
SAW_NDT_EXPORT double wrappedAngle(double angle);

/// The cross-product matrix of v: skewSymmetric(v) * w == v.cross(w).
SAW_NDT_EXPORT Eigen::Matrix3d skewSymmetric(const Eigen::Vector3d& v);

/// The transform with its rotation replaced by the nearest rotation matrix. Products of many poses drift away from
/// orthonormality, and `T1 * T2.inverse() * T1` multiplies that drift: normalize what such a product returns.
SAW_NDT_EXPORT Eigen::Isometry3d normalizedRotation(const Eigen::Isometry3d& T);

/// Throws std::invalid_argument that names the transform unless it is finite and its rotation is one to within 1e-6.
SAW_NDT_EXPORT void requireRigid(const Eigen::Isometry3d& T, const char* name);

/// The rotation whose axis times angle (rad) is `rotation_vector`.
SAW_NDT_EXPORT Eigen::Matrix3d rotationFromVector(const Eigen::Vector3d& rotation_vector);

/// The inverse of rotationFromVector(), of length 0 to pi.
SAW_NDT_EXPORT Eigen::Vector3d rotationVector(const Eigen::Matrix3d& R);

/// The J for which a body that moves at v (m/s, own frame) and turns at w (rad/s) for t seconds comes to J(w t) v t.
SAW_NDT_EXPORT Eigen::Matrix3d meanRotation(const Eigen::Vector3d& rotation_vector);

/// The angle of a rotation in radians, 0 to pi; exact for small angles too.
SAW_NDT_EXPORT double rotationAngle(const Eigen::Matrix3d& R);

/// Yaw in radians: the direction of the body's x axis in the horizontal plane of the parent frame.
SAW_NDT_EXPORT double heading(const Eigen::Isometry3d& T);

/// The transform that translation (m) and roll, pitch, yaw (rad; R = Rz(yaw) Ry(pitch) Rx(roll)) state.
SAW_NDT_EXPORT Eigen::Isometry3d transformFromXyzRpy(const Vector6d& xyz_rpy);

/// The inverse of transformFromXyzRpy(): x y z roll pitch yaw.
SAW_NDT_EXPORT Vector6d xyzRpyFromTransform(const Eigen::Isometry3d& T);

/// The rotation Rx(roll) Ry(pitch) Rz(yaw) of PCL's parameters (rad).
SAW_NDT_EXPORT Eigen::Matrix3d rotationFromEuler(const Eigen::Vector3d& roll_pitch_yaw);
/// The inverse of rotationFromEuler(): roll, pitch within +-pi/2, yaw.
SAW_NDT_EXPORT Eigen::Vector3d eulerFromRotation(const Eigen::Matrix3d& R);

}  // namespace saw_ndt
