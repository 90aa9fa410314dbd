#include "localization/uncertain_pose.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "registration/pose_lengths.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/registration/source_points.h"

namespace saw_ndt {
namespace {

// The squared Mahalanobis distance of six numbers that one error in a thousand exceeds.
constexpr double kUnlikelySquaredMahalanobis = 22.5;

// The squared Mahalanobis distance of three numbers that one error in a thousand exceeds.
constexpr double kOutlierSquaredMahalanobis = 16.3;

// Standard deviation of a position that nobody knows (m).
constexpr double kAnywhere_m = 1.0e5;

}  // namespace

namespace internal {

Matrix6d diagonal(double translation, double rotation) {
  Vector6d values;
  values << Eigen::Vector3d::Constant(translation * translation), Eigen::Vector3d::Constant(rotation * rotation);
  return values.asDiagonal();
}

Matrix6d turned(const Matrix6d& covariance, const Eigen::Matrix3d& R) {
  Matrix6d both = Matrix6d::Zero();
  both.topLeftCorner<3, 3>() = R;
  both.bottomRightCorner<3, 3>() = R;
  return both * covariance * both.transpose();
}

Matrix6d sumOfAlike(const Matrix6d& a, const Matrix6d& b) {
  const auto size = [](const Matrix6d& covariance) {
    return std::sqrt(covariance.topLeftCorner<3, 3>().trace() +
                     kRotationArm_m * kRotationArm_m * covariance.bottomRightCorner<3, 3>().trace());
  };
  const double size_a = size(a), size_b = size(b);
  if (!(size_a > 0.0) || !(size_b > 0.0)) return a + b;
  return (1.0 + size_b / size_a) * a + (1.0 + size_a / size_b) * b;
}

void moveBy(const Vector6d& difference, Eigen::Isometry3d& T) {
  T.translation() += difference.head<3>();
  T.linear() = rotationFromVector(difference.tail<3>()) * T.linear();
  T = normalizedRotation(T);
}

Innovation innovationOf(const MeasuredPosition& measured, const Eigen::Vector3d& position_m,
                        const Eigen::Matrix3d& covariance) {
  checkOption((measured.position_m.array().abs() <= kFarthest_m).all(), "position", measured.position_m.transpose(),
              "finite and no more than 1e9 m away");
  checkOption(measured.covariance.allFinite() && (measured.covariance.diagonal().array() >= 0.0).all(),
              "position.covariance", measured.covariance.diagonal().transpose(), "finite, without negative variances");
  Innovation innovation;
  innovation.way_m = measured.position_m - position_m;
  innovation.covariance = covariance + measured.covariance;
  innovation.is_outlier =
      !(innovation.way_m.dot(innovation.covariance.ldlt().solve(innovation.way_m)) <= kOutlierSquaredMahalanobis);
  return innovation;
}

}  // namespace internal

using namespace internal;

Vector6d poseDifference(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) {
  Vector6d difference;
  difference << to.translation() - from.translation(), rotationVector(to.linear() * from.linear().transpose());
  return difference;
}

std::optional<UncertainPose> correctedBy(const MeasuredPosition& position, const UncertainPose& pose) {
  const Innovation innovation =
      innovationOf(position, pose.T_map_base.translation(), pose.covariance.topLeftCorner<3, 3>());
  if (innovation.is_outlier) return std::nullopt;
  const Eigen::Matrix<double, 6, 3> gain = pose.covariance.leftCols<3>() * innovation.covariance.inverse();
  UncertainPose corrected = pose;
  moveBy(gain * innovation.way_m, corrected.T_map_base);
  Matrix6d remaining = Matrix6d::Identity();
  remaining.leftCols<3>() -= gain;
  corrected.covariance =
      remaining * pose.covariance * remaining.transpose() + gain * position.covariance * gain.transpose();
  return corrected;
}

Matrix6d anywhereCovariance() { return diagonal(kAnywhere_m, kPi); }

bool isUnlikely(const Vector6d& error, const Matrix6d& covariance) {
  return error.dot(covariance.ldlt().solve(error)) > kUnlikelySquaredMahalanobis;
}

Eigen::Isometry3d keptAlongFreeDirections(const Eigen::Isometry3d& T_map_predicted,
                                          const Eigen::Isometry3d& T_map_aligned,
                                          const PoseDirections& free_directions) {
  if (free_directions.cols() == 0) return T_map_aligned;
  const Vector6d difference = poseDifference(T_map_predicted, T_map_aligned);
  const Vector6d held = difference - internal::projectorOnto(free_directions) * difference;
  Eigen::Isometry3d T_map_kept = T_map_predicted;
  T_map_kept.translation() += held.head<3>();
  T_map_kept.linear() = rotationFromVector(held.tail<3>()) * T_map_predicted.linear();
  return normalizedRotation(T_map_kept);
}

}  // namespace saw_ndt
