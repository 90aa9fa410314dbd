#include "saw_ndt/localization/motion_prediction.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "localization/uncertain_pose.h"
#include "registration/pose_lengths.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {

using namespace internal;

namespace {

// Stamps that differ by less are of one moment (s).
constexpr double kSameMoment_s = 1e-6;

// A stamp that is further back than this, and the last of so many in a row that are not after the last, are of a clock
// that was set back (s).
constexpr double kLongestWayBack_s = 1.0;
constexpr int kMostLateScans = 2;

// After a longer gap the stamp is doubted as much as the scans between are thought to be lost (s). Half of the time is
// the standard deviation then.
constexpr double kLongestGap_s = 0.35;
constexpr double kDoubtfulShare = 0.5;

// How long it may have been to a scan whose stamp is not after the last, beside that, and to one by a clock that was
// set back, one sigma each (s).
constexpr double kLateSigma_s = 0.1;
constexpr double kSetBackSigma_s = 0.5;

// How long an acceleration lasts (s).
constexpr double kAccelerationTime_s = 10.0;

// Standard deviation of a turn rate that is not known, of a vehicle (rad/s).
constexpr double kUnknownTurnRate_radps = 0.5;

// A pose that is surer than this tells velocities (m).
constexpr double kSureSigma_m = 0.1;

// Adding up the recent past of the overlap.
constexpr double kNewOverlapShare = 0.1;

Eigen::Vector3d bounded(const Eigen::Vector3d& vector, double limit) {
  const double length = vector.norm();
  return length > limit ? Eigen::Vector3d(vector * (limit / length)) : vector;
}

}  // namespace

const char* toString(TrackStatus status) {
  switch (status) {
    case TrackStatus::NOT_INITIALIZED:
      return "not initialized";
    case TrackStatus::TRACKING:
      return "tracking";
    case TrackStatus::COASTING:
      return "coasting";
    case TrackStatus::RELOCALIZING:
      return "relocalizing";
    case TrackStatus::LOST:
      return "lost";
  }
  return "unknown";
}

void MotionPredictionOptions::check() const {
  const auto positive = [](double value) { return value > 0.0 && std::isfinite(value); };
  checkOption(positive(max_speed_mps), "max_speed_mps", max_speed_mps, "positive");
  checkOption(positive(max_turn_rate_radps), "max_turn_rate_radps", max_turn_rate_radps, "positive");
  checkOption(positive(acceleration_sigma_mps2), "acceleration_sigma_mps2", acceleration_sigma_mps2, "positive");
  checkOption(positive(turn_acceleration_sigma_radps2), "turn_acceleration_sigma_radps2",
              turn_acceleration_sigma_radps2, "positive");
  checkOption(positive(unknown_speed_sigma_mps), "unknown_speed_sigma_mps", unknown_speed_sigma_mps, "positive");
  checkOption(positive(initial_sigma_m), "initial_sigma_m", initial_sigma_m, "positive");
  checkOption(positive(initial_sigma_deg), "initial_sigma_deg", initial_sigma_deg, "positive");
  checkOption(positive(max_extrapolation_s), "max_extrapolation_s", max_extrapolation_s, "positive");
  checkOption(lost_after_scans >= 1, "lost_after_scans", lost_after_scans, "1 or more");
}

MotionPrediction::MotionPrediction(const MotionPredictionOptions& options) : options_(options) { options_.check(); }

void MotionPrediction::reset(const Eigen::Isometry3d& T_map_base) {
  requireRigid(T_map_base, "T_map_base");
  state_ = TrackState();
  late_scans_ = 0;
  state_.status = TrackStatus::TRACKING;
  state_.pose_known = true;
  state_.T_map_base = T_map_base;
  state_.covariance = diagonal(options_.initial_sigma_m, radiansFromDegrees(options_.initial_sigma_deg));
  covariance_.setZero();
  covariance_.block<6, 6>(0, 0) = state_.covariance;
  covariance_.block<6, 6>(6, 6) = diagonal(options_.unknown_speed_sigma_mps, kUnknownTurnRate_radps);
  covariance_.block<6, 6>(12, 12) = diagonal(options_.acceleration_sigma_mps2, options_.turn_acceleration_sigma_radps2);
  motion_.reset();
  motion_complete_ = true;
}

void MotionPrediction::resetUnknown() {
  reset(Eigen::Isometry3d::Identity());
  state_.status = TrackStatus::LOST;
  state_.pose_known = false;
  state_.covariance = anywhereCovariance();
  covariance_.block<6, 6>(0, 0) = state_.covariance;
}

Matrix6d MotionPrediction::restart(const MeasuredPose& pose, double stamp_s) {
  checkOption(std::isfinite(stamp_s), "stamp_s", stamp_s, "finite");
  const std::optional<double> usual_overlap = state_.usual_overlap;
  reset(pose.T_map_base);
  state_.usual_overlap = usual_overlap ? usual_overlap : pose.overlap;
  state_.covariance = pose.covariance;
  covariance_.block<6, 6>(0, 0) = pose.covariance;
  state_.stamp_s = stamp_s;
  return state_.covariance;
}

void MotionPrediction::move(const std::optional<MeasuredMotion>& motion) {
  if (motion) {
    requireRigid(motion->T_before_now, "T_before_now");
    checkOption(motion->covariance.allFinite() && (motion->covariance.diagonal().array() >= 0.0).all(),
                "motion.covariance", motion->covariance.diagonal().transpose(), "finite, without negative variances");
  }
  if (!state_.stamp_s) return;  // the initial pose is that of this scan
  motion_complete_ = motion_complete_ && motion.has_value();
  if (!motion_complete_) {
    motion_.reset();
    return;
  }
  if (!motion_) motion_ = MeasuredMotion();
  const Eigen::Matrix3d R_last_before = motion_->T_before_now.linear();
  Matrix6d F = Matrix6d::Identity();
  F.topRightCorner<3, 3>() -= skewSymmetric(R_last_before * motion->T_before_now.translation());
  motion_->covariance = sumOfAlike(F * motion_->covariance * F.transpose(), turned(motion->covariance, R_last_before));
  motion_->T_before_now = normalizedRotation(motion_->T_before_now * motion->T_before_now);
}

Matrix6d MotionPrediction::correct(const MeasuredPosition& position) {
  const Innovation innovation =
      innovationOf(position, state_.T_map_base.translation(), covariance_.topLeftCorner<3, 3>());
  if (innovation.is_outlier) return state_.covariance;
  Eigen::Matrix<double, 18, 3> gain = covariance_.leftCols<3>() * innovation.covariance.inverse();
  gain.bottomRows<6>().setZero();  // accelerations are reckoned with, not estimated
  const Eigen::Matrix<double, 18, 1> correction = gain * innovation.way_m;
  moveBy(correction.head<6>(), state_.T_map_base);
  const Eigen::Matrix3d R_base_map = state_.T_map_base.linear().transpose();
  state_.velocity_base_mps =
      bounded(state_.velocity_base_mps + R_base_map * correction.segment<3>(6), options_.max_speed_mps);
  state_.turn_rate_base_radps =
      bounded(state_.turn_rate_base_radps + R_base_map * correction.segment<3>(9), options_.max_turn_rate_radps);
  Covariance remaining = Covariance::Identity();
  remaining.leftCols<3>() -= gain;
  covariance_ = remaining * covariance_ * remaining.transpose() + gain * position.covariance * gain.transpose();
  state_.covariance = covariance_.topLeftCorner<6, 6>();
  return state_.covariance;
}

// What the stamps say of the time since the last pose, and how far they are believed.
struct MotionPrediction::Interval {
  double duration_s = 0.0;   // for which the motion goes on
  double sigma_s = 0.0;      // of it
  bool comes_after = false;  // there is a last pose with a stamp, and this one is after it
  bool set_back = false;     // by another clock than that of the last pose
  bool too_long = false;     // nothing of the motion is known any more
};

MotionPrediction::Interval MotionPrediction::intervalTo(double stamp_s) const {
  Interval interval;
  const std::optional<double> since_last_s = state_.timeSinceLast(stamp_s);
  if (!since_last_s) return interval;
  interval.comes_after = *since_last_s >= kSameMoment_s;
  interval.set_back = *since_last_s < -kLongestWayBack_s;
  interval.too_long = *since_last_s > options_.max_extrapolation_s;
  if (interval.set_back) {
    interval.sigma_s = kSetBackSigma_s;
  } else if (interval.too_long) {
    interval.sigma_s = options_.max_extrapolation_s;
  } else {
    interval.duration_s = *since_last_s;
    if (*since_last_s > kLongestGap_s) interval.sigma_s = kDoubtfulShare * *since_last_s;
    if (*since_last_s < 0.0) interval.sigma_s = kLateSigma_s - kDoubtfulShare * *since_last_s;
  }
  return interval;
}

MotionPrediction::Covariance MotionPrediction::propagated(const Interval& interval) const {
  const double duration_s = interval.duration_s;
  Covariance F = Covariance::Identity();
  F.block<6, 6>(0, 6).diagonal().setConstant(duration_s);
  F.block<6, 6>(0, 12).diagonal().setConstant(0.5 * duration_s * duration_s);
  F.block<6, 6>(6, 12).diagonal().setConstant(duration_s);
  const double lasting = std::exp(-std::abs(duration_s) / kAccelerationTime_s);
  F.block<6, 6>(12, 12).diagonal().setConstant(lasting);
  // A wrong heading leads the motion astray.
  const Eigen::Matrix3d R = state_.T_map_base.linear();
  Vector6d velocity;
  velocity << R * state_.velocity_base_mps, R * state_.turn_rate_base_radps;
  F.block<3, 3>(0, 3) -= skewSymmetric(velocity.head<3>() * duration_s);
  Covariance result = F * covariance_ * F.transpose();
  result.block<6, 6>(12, 12) = diagonal(options_.acceleration_sigma_mps2, options_.turn_acceleration_sigma_radps2);
  if (interval.too_long) {
    result.block<6, 12>(0, 6).setZero();
    result.block<12, 6>(6, 0).setZero();
    result.block<6, 6>(6, 12).setZero();
    result.block<6, 6>(12, 6).setZero();
    result.block<6, 6>(6, 6) = diagonal(options_.unknown_speed_sigma_mps, kUnknownTurnRate_radps);
    velocity.setZero();
  }
  if (motion_) {
    Matrix6d F_pose = Matrix6d::Identity();
    F_pose.topRightCorner<3, 3>() -= skewSymmetric(R * motion_->T_before_now.translation());
    result.topLeftCorner<6, 6>() =
        F_pose * covariance_.topLeftCorner<6, 6>() * F_pose.transpose() + turned(motion_->covariance, R);
    result.topRightCorner<6, 12>().setZero();
    result.bottomLeftCorner<12, 6>().setZero();
  } else if (interval.sigma_s > 0.0) {
    result.topLeftCorner<6, 6>() +=
        interval.sigma_s * interval.sigma_s * (velocity * velocity.transpose() + result.block<6, 6>(6, 6));
  }
  return result;
}

bool MotionPrediction::isSurprising(const MeasuredPose& pose, double stamp_s) const {
  Interval interval = intervalTo(stamp_s);
  if (!interval.set_back && !interval.too_long) interval.sigma_s = 0.0;
  return isUnlikely(poseDifference(predict(stamp_s), pose.T_map_base),
                    propagated(interval).topLeftCorner<6, 6>() + pose.covariance);
}

Matrix6d MotionPrediction::accept(const MeasuredPose& pose, double stamp_s) {
  requireRigid(pose.T_map_base, "T_map_base");
  checkOption(std::isfinite(stamp_s), "stamp_s", stamp_s, "finite");
  if (state_.status == TrackStatus::NOT_INITIALIZED) reset(pose.T_map_base);
  const Interval interval = intervalTo(stamp_s);
  const Covariance predicted = propagated(interval);
  const Matrix6d held = Matrix6d::Identity() - projectorOnto(pose.free_directions);
  Eigen::Matrix<double, 18, 6> gain = Eigen::Matrix<double, 18, 6>::Zero();
  gain.topRows<6>() = held;
  const auto updated = [&]() -> Covariance {
    Covariance remaining = Covariance::Identity();
    remaining.leftCols<6>() -= gain;
    return remaining * predicted * remaining.transpose() + gain * pose.covariance * gain.transpose();
  };
  state_.status = TrackStatus::TRACKING;
  state_.pose_known = true;
  state_.rejected_scans = 0;
  if (!pose.learn_velocity) late_scans_ = 0;
  if (pose.learn_velocity && comesLate(interval)) return updated().topLeftCorner<6, 6>();

  if (interval.too_long) {
    state_.velocity_base_mps.setZero();
    state_.turn_rate_base_radps.setZero();
    state_.velocity_known = false;
  } else if (interval.comes_after && (pose.learn_velocity || !state_.velocity_known)) {
    gain.middleRows<6>(6) = learnVelocity(pose, stamp_s, predicted) * held;
  }
  covariance_ = updated();
  motion_.reset();
  motion_complete_ = true;
  state_.T_map_base = pose.T_map_base;
  state_.covariance = covariance_.topLeftCorner<6, 6>();
  state_.stamp_s = stamp_s;
  if (pose.overlap) {
    state_.usual_overlap =
        *pose.overlap * kNewOverlapShare + state_.usual_overlap.value_or(*pose.overlap) * (1.0 - kNewOverlapShare);
  }
  return state_.covariance;
}

bool MotionPrediction::comesLate(const Interval& interval) {
  const bool is_late = state_.stamp_s && !interval.comes_after && !interval.set_back;
  late_scans_ = is_late ? late_scans_ + 1 : 0;
  if (late_scans_ <= kMostLateScans) return is_late;
  late_scans_ = 0;
  return false;
}

Matrix6d MotionPrediction::learnVelocity(const MeasuredPose& pose, double stamp_s, const Covariance& predicted) {
  const double elapsed_s = *state_.timeSinceLast(stamp_s);
  const Eigen::Isometry3d T_last_now = state_.T_map_base.inverse() * pose.T_map_base;
  const Eigen::Vector3d turned = rotationVector(T_last_now.linear());
  Matrix6d gain = Matrix6d::Identity() / elapsed_s;
  Eigen::Vector3d velocity_mps =
      pose.T_map_base.linear() * (meanRotation(turned).inverse() * T_last_now.translation() / elapsed_s);
  // Where the last pose was unsure, such as along a tunnel that has ended, the way from it does not tell the velocity;
  // what is known of how position and velocity went wrong together does (the Kalman gain).
  const Eigen::Vector3d innovation = pose.T_map_base.translation() - predict(stamp_s).translation();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> last(state_.covariance.topLeftCorner<3, 3>());
  for (int k = 0; k < 3; ++k) {
    if (last.eigenvalues()[k] < kSureSigma_m * kSureSigma_m) continue;
    const Eigen::Vector3d u = last.eigenvectors().col(k);
    const double position_variance =
        u.dot((predicted.topLeftCorner<3, 3>() + pose.covariance.topLeftCorner<3, 3>()) * u);
    const double more_gain = u.dot(predicted.block<3, 3>(6, 0) * u) / position_variance - 1.0 / elapsed_s;
    gain.topLeftCorner<3, 3>() += more_gain * u * u.transpose();
    velocity_mps += more_gain * u * u.dot(innovation);
  }
  state_.velocity_base_mps = bounded(pose.T_map_base.linear().transpose() * velocity_mps, options_.max_speed_mps);
  state_.turn_rate_base_radps = bounded(turned / elapsed_s, options_.max_turn_rate_radps);
  state_.velocity_known = true;
  return gain;
}

void MotionPrediction::reject(double stamp_s, bool searched) {
  if (state_.status == TrackStatus::NOT_INITIALIZED) return;
  ++state_.rejected_scans;
  const bool is_lost = !state_.pose_known || state_.rejected_scans >= options_.lost_after_scans;
  state_.status = !is_lost ? TrackStatus::COASTING : searched ? TrackStatus::RELOCALIZING : TrackStatus::LOST;
  if (!std::isfinite(stamp_s)) return;
  if (!state_.stamp_s) {
    state_.stamp_s = stamp_s;
    return;
  }
  const Interval interval = intervalTo(stamp_s);
  if (interval.comes_after || comesLate(interval)) return;
  // The clock was set back: how long it has been since the last pose is known no more.
  Interval unknown;
  unknown.sigma_s = kSetBackSigma_s;
  covariance_ = propagated(unknown);
  state_.covariance = covariance_.topLeftCorner<6, 6>();
  state_.stamp_s = stamp_s;
}

Eigen::Isometry3d MotionPrediction::predict(double stamp_s) const {
  checkOption(std::isfinite(stamp_s), "stamp_s", stamp_s, "finite");
  if (state_.status == TrackStatus::NOT_INITIALIZED) {
    throw std::logic_error("no initial pose: setInitialPose() has not been called");
  }
  if (motion_) return normalizedRotation(state_.T_map_base * motion_->T_before_now);
  const double duration_s = intervalTo(stamp_s).duration_s;
  if (!state_.velocity_known || duration_s == 0.0) return state_.T_map_base;
  Eigen::Isometry3d T_last_next = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d turned = state_.turn_rate_base_radps * duration_s;
  T_last_next.translation() = meanRotation(turned) * state_.velocity_base_mps * duration_s;
  T_last_next.linear() = rotationFromVector(turned);
  return normalizedRotation(state_.T_map_base * T_last_next);
}

Matrix6d MotionPrediction::predictedCovariance(double stamp_s) const {
  checkOption(std::isfinite(stamp_s), "stamp_s", stamp_s, "finite");
  return propagated(intervalTo(stamp_s)).topLeftCorner<6, 6>();
}

}  // namespace saw_ndt
