#include "saw_ndt/evaluation/trajectory_alignment.h"

#include <Eigen/SVD>
#include <cmath>
#include <stdexcept>

namespace saw_ndt {

namespace {

constexpr double kLeastShare = 1e-12;
constexpr double kLeastSpread_m2 = 1e-12;  // a pair

/// The positions' means and sum (r - mean r) (e - mean e)^T.
struct PositionMoments {
  Eigen::Vector3d reference_mean_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d estimate_mean_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();

  explicit PositionMoments(const std::vector<PosePair>& pairs) {
    const auto count = static_cast<double>(pairs.size());
    for (const PosePair& pair : pairs) {
      reference_mean_m += pair.T_map_reference.translation() / count;
      estimate_mean_m += pair.T_map_estimate.translation() / count;
    }
    for (const PosePair& pair : pairs) {
      covariance_m2 += (pair.T_map_reference.translation() - reference_mean_m) *
                       (pair.T_map_estimate.translation() - estimate_mean_m).transpose();
    }
  }

  Eigen::Isometry3d withRotation(const Eigen::Matrix3d& R) const {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = R;
    T.translation() = reference_mean_m - R * estimate_mean_m;
    return T;
  }
};

[[noreturn]] void refuse(const std::vector<PosePair>& pairs, const std::string& where, const std::string& advice) {
  throw std::invalid_argument("the estimate cannot be aligned: the positions of the " + std::to_string(pairs.size()) +
                              " pairs are " + where + ", which tells no rotation; " + advice);
}

Eigen::Isometry3d rigidAlignment(const std::vector<PosePair>& pairs) {
  const PositionMoments moments(pairs);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(moments.covariance_m2, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d spread_m2 = svd.singularValues();
  if (spread_m2(0) <= kLeastSpread_m2 * static_cast<double>(pairs.size()) ||
      spread_m2(1) <= kLeastShare * spread_m2(0)) {
    refuse(pairs, "the same or on one line", "align by yaw, origin or none");
  }
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) signs.z() = -1.0;
  return moments.withRotation(svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose());
}

Eigen::Isometry3d yawAlignment(const std::vector<PosePair>& pairs) {
  const PositionMoments moments(pairs);
  const Eigen::Matrix3d& C = moments.covariance_m2;
  const double sine_m2 = C(1, 0) - C(0, 1), cosine_m2 = C(0, 0) + C(1, 1);
  const double length_m2 = std::hypot(sine_m2, cosine_m2);
  if (length_m2 <= kLeastSpread_m2 * static_cast<double>(pairs.size()) ||
      length_m2 <= kLeastShare * C.topLeftCorner<2, 2>().norm()) {
    refuse(pairs, "the same seen from above", "align by origin or none");
  }
  return moments.withRotation(
      Eigen::AngleAxisd(std::atan2(sine_m2, cosine_m2), Eigen::Vector3d::UnitZ()).toRotationMatrix());
}

}  // namespace

std::string toString(TrajectoryAlignment alignment) {
  switch (alignment) {
    case TrajectoryAlignment::NONE:
      return "none";
    case TrajectoryAlignment::ORIGIN:
      return "origin";
    case TrajectoryAlignment::YAW:
      return "yaw";
    case TrajectoryAlignment::SE3:
      return "se3";
  }
  return "";
}

Eigen::Isometry3d alignmentTransform(const std::vector<PosePair>& pairs, TrajectoryAlignment alignment) {
  if (pairs.empty()) throw std::invalid_argument("the alignment of no pairs");
  switch (alignment) {
    case TrajectoryAlignment::NONE:
      break;
    case TrajectoryAlignment::ORIGIN:
      return normalizedRotation(pairs.front().T_map_reference * pairs.front().T_map_estimate.inverse());
    case TrajectoryAlignment::YAW:
      return yawAlignment(pairs);
    case TrajectoryAlignment::SE3:
      return rigidAlignment(pairs);
  }
  return Eigen::Isometry3d::Identity();
}

std::vector<PosePair> alignedPairs(std::vector<PosePair> pairs, TrajectoryAlignment alignment) {
  const Eigen::Isometry3d T = alignmentTransform(pairs, alignment);
  if (alignment == TrajectoryAlignment::NONE) return pairs;
  for (PosePair& pair : pairs) pair.T_map_estimate = T * pair.T_map_estimate;
  return pairs;
}

}  // namespace saw_ndt
