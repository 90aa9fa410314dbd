#pragma once

#include <Eigen/Core>

#include "saw_ndt/localization/motion_prediction.h"

namespace saw_ndt::internal {

/// The covariance of a pose whose coordinates are independent: standard deviations (m, rad).
Matrix6d diagonal(double translation, double rotation);

/// A covariance by (translation, rotation) in the axes of another frame.
Matrix6d turned(const Matrix6d& covariance, const Eigen::Matrix3d& R);

/// The covariance of a sum of errors that may be alike, as those of a drift: standard deviations add up.
Matrix6d sumOfAlike(const Matrix6d& a, const Matrix6d& b);

/// Moves a pose by a poseDifference().
void moveBy(const Vector6d& difference, Eigen::Isometry3d& T);

/// How far a measured position is from one that is known.
struct Innovation {
  Eigen::Vector3d way_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< the sum of both
  bool is_outlier = false;
};

/// @throws std::invalid_argument where the measurement is not finite
Innovation innovationOf(const MeasuredPosition& measured, const Eigen::Vector3d& position_m,
                        const Eigen::Matrix3d& covariance);

}  // namespace saw_ndt::internal
