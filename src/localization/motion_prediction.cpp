#include "saw_ndt/localization/motion_prediction.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {
namespace {

// Stamps that differ by less are of one moment (s).
constexpr double kSameMoment_s = 1e-6;

// A stamp that is further back than this is of a clock that was set anew (s).
constexpr double kLongestWayBack_s = 1.0;

// How long an acceleration lasts (s).
constexpr double kAccelerationTime_s = 10.0;

// Standard deviations of a velocity that is not known: of a vehicle in town (m/s), and of its turns (rad/s).
constexpr double kUnknownSpeed_mps = 15.0;
constexpr double kUnknownTurnRate_radps = 0.5;

// A pose that is surer than this tells velocities (m).
constexpr double kSureSigma_m = 0.1;

// Adding up the recent past of the overlap.
constexpr double kNewOverlapShare = 0.1;

Eigen::Vector3d bounded(const Eigen::Vector3d& vector, double limit) {
  const double length = vector.norm();
  return length > limit ? Eigen::Vector3d(vector * (limit / length)) : vector;
}

Matrix6d diagonal(double translation, double rotation) {
  Vector6d values;
  values << Eigen::Vector3d::Constant(translation * translation), Eigen::Vector3d::Constant(rotation * rotation);
  return values.asDiagonal();
}

// Projects a difference of poses onto what is held.
Matrix6d projectorOntoHeld(const PoseDirections& free_directions) {
  Vector6d arm = Vector6d::Ones();
  arm.tail<3>().setConstant(kRotationArm_m);
  const Matrix6d held = Matrix6d::Identity() - free_directions * free_directions.transpose();
  return arm.cwiseInverse().asDiagonal() * held * arm.asDiagonal();
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
    case TrackStatus::LOST:
      return "lost";
  }
  return "unknown";
}

Vector6d poseDifference(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) {
  Vector6d difference;
  difference << to.translation() - from.translation(), rotationVector(to.linear() * from.linear().transpose());
  return difference;
}

Eigen::Isometry3d keptAlongFreeDirections(const Eigen::Isometry3d& T_map_predicted,
                                          const Eigen::Isometry3d& T_map_aligned,
                                          const PoseDirections& free_directions) {
  if (free_directions.cols() == 0) return T_map_aligned;
  const Vector6d held = projectorOntoHeld(free_directions) * poseDifference(T_map_predicted, T_map_aligned);
  Eigen::Isometry3d T_map_kept = T_map_predicted;
  T_map_kept.translation() += held.head<3>();
  T_map_kept.linear() = rotationFromVector(held.tail<3>()) * T_map_predicted.linear();
  return normalizedRotation(T_map_kept);
}

void MotionPredictionOptions::check() const {
  const auto positive = [](double value) { return value > 0.0 && std::isfinite(value); };
  checkOption(positive(max_speed_mps), "max_speed_mps", max_speed_mps, "positive");
  checkOption(positive(max_turn_rate_radps), "max_turn_rate_radps", max_turn_rate_radps, "positive");
  checkOption(positive(acceleration_sigma_mps2), "acceleration_sigma_mps2", acceleration_sigma_mps2, "positive");
  checkOption(positive(turn_acceleration_sigma_radps2), "turn_acceleration_sigma_radps2",
              turn_acceleration_sigma_radps2, "positive");
  checkOption(positive(initial_sigma_m), "initial_sigma_m", initial_sigma_m, "positive");
  checkOption(positive(initial_sigma_deg), "initial_sigma_deg", initial_sigma_deg, "positive");
  checkOption(positive(max_extrapolation_s), "max_extrapolation_s", max_extrapolation_s, "positive");
  checkOption(lost_after_scans >= 1, "lost_after_scans", lost_after_scans, "1 or more");
}

MotionPrediction::MotionPrediction(const MotionPredictionOptions& options) : options_(options) { options_.check(); }

void MotionPrediction::reset(const Eigen::Isometry3d& T_map_base) {
  requireRigid(T_map_base, "T_map_base");
  state_ = TrackState();
  state_.status = TrackStatus::TRACKING;
  state_.T_map_base = T_map_base;
  state_.covariance = diagonal(options_.initial_sigma_m, radiansFromDegrees(options_.initial_sigma_deg));
  covariance_.setZero();
  covariance_.block<6, 6>(0, 0) = state_.covariance;
  covariance_.block<6, 6>(6, 6) = diagonal(kUnknownSpeed_mps, kUnknownTurnRate_radps);
  covariance_.block<6, 6>(12, 12) = diagonal(options_.acceleration_sigma_mps2, options_.turn_acceleration_sigma_radps2);
}

double MotionPrediction::elapsed(double stamp_s) const {
  const double elapsed_s = state_.timeSinceLast(stamp_s).value_or(0.0);
  if (elapsed_s < -kLongestWayBack_s) return 0.0;
  return std::min(elapsed_s, options_.max_extrapolation_s);
}

MotionPrediction::Covariance MotionPrediction::propagated(double elapsed_s) const {
  Covariance F = Covariance::Identity();
  F.block<6, 6>(0, 6).diagonal().setConstant(elapsed_s);
  F.block<6, 6>(0, 12).diagonal().setConstant(0.5 * elapsed_s * elapsed_s);
  F.block<6, 6>(6, 12).diagonal().setConstant(elapsed_s);
  const double lasting = std::exp(-std::abs(elapsed_s) / kAccelerationTime_s);
  F.block<6, 6>(12, 12).diagonal().setConstant(lasting);
  // A wrong heading leads the motion astray.
  F.block<3, 3>(0, 3) -= skewSymmetric(state_.T_map_base.linear() * state_.velocity_base_mps * elapsed_s);
  Covariance result = F * covariance_ * F.transpose();
  result.block<6, 6>(12, 12) = diagonal(options_.acceleration_sigma_mps2, options_.turn_acceleration_sigma_radps2);
  return result;
}

void MotionPrediction::accept(const MeasuredPose& pose, double stamp_s) {
  requireRigid(pose.T_map_base, "T_map_base");
  checkOption(std::isfinite(stamp_s), "stamp_s", stamp_s, "finite");
  if (state_.status == TrackStatus::NOT_INITIALIZED) reset(pose.T_map_base);
  const std::optional<double> since_last_s = state_.timeSinceLast(stamp_s);
  // A late scan is where the motion says that it was. One that is not shows that the clock was set back.
  const bool clock_was_set_back =
      since_last_s.has_value() && (*since_last_s < -kLongestWayBack_s || (*since_last_s < 0.0 && !pose.learn_velocity));
  state_.status = TrackStatus::TRACKING;
  state_.rejected_scans = 0;
  if (since_last_s && !clock_was_set_back && *since_last_s < kSameMoment_s) return;

  const bool comes_after = since_last_s.has_value() && !clock_was_set_back;
  const Covariance predicted = propagated(elapsed(stamp_s));
  const Matrix6d held = projectorOntoHeld(pose.free_directions);
  Eigen::Matrix<double, 18, 6> gain = Eigen::Matrix<double, 18, 6>::Zero();
  gain.topRows<6>() = held;
  if (comes_after && (pose.learn_velocity || !state_.velocity_known)) {
    const double elapsed_s = *since_last_s;
    const Eigen::Isometry3d T_map_predicted = predict(stamp_s);
    const Eigen::Isometry3d T_last_now = state_.T_map_base.inverse() * pose.T_map_base;
    const Eigen::Vector3d turned = rotationVector(T_last_now.linear());
    Matrix6d velocity_gain = Matrix6d::Identity() / elapsed_s;
    Eigen::Vector3d velocity_mps =
        pose.T_map_base.linear() * (meanRotation(turned).inverse() * T_last_now.translation() / elapsed_s);
    if (state_.velocity_known) {
      // Where the last pose was unsure, such as along a tunnel that has ended, the way from it does not tell the
      // velocity; what is known of how position and velocity went wrong together does (the Kalman gain).
      const Eigen::Vector3d innovation = pose.T_map_base.translation() - T_map_predicted.translation();
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> last(state_.covariance.topLeftCorner<3, 3>());
      for (int k = 0; k < 3; ++k) {
        if (last.eigenvalues()[k] < kSureSigma_m * kSureSigma_m) continue;
        const Eigen::Vector3d u = last.eigenvectors().col(k);
        const double position_variance =
            u.dot((predicted.topLeftCorner<3, 3>() + pose.covariance.topLeftCorner<3, 3>()) * u);
        const double kalman_gain = u.dot(predicted.block<3, 3>(6, 0) * u) / position_variance;
        velocity_gain.topLeftCorner<3, 3>() += (kalman_gain - 1.0 / elapsed_s) * u * u.transpose();
        velocity_mps += (kalman_gain - 1.0 / elapsed_s) * u * u.dot(innovation);
      }
    }
    gain.middleRows<6>(6) = velocity_gain * held;
    state_.velocity_base_mps = pose.T_map_base.linear().transpose() * velocity_mps;
    state_.turn_rate_base_radps = turned / elapsed_s;
    state_.velocity_known = true;
    state_.velocity_base_mps = bounded(state_.velocity_base_mps, options_.max_speed_mps);
    state_.turn_rate_base_radps = bounded(state_.turn_rate_base_radps, options_.max_turn_rate_radps);
  }
  Covariance remaining = Covariance::Identity();
  remaining.leftCols<6>() -= gain;
  covariance_ = remaining * predicted * remaining.transpose() + gain * pose.covariance * gain.transpose();

  state_.T_map_base = pose.T_map_base;
  state_.covariance = covariance_.topLeftCorner<6, 6>();
  state_.stamp_s = stamp_s;
  if (pose.overlap) {
    state_.usual_overlap =
        *pose.overlap * kNewOverlapShare + state_.usual_overlap.value_or(*pose.overlap) * (1.0 - kNewOverlapShare);
  }
}

void MotionPrediction::reject() {
  if (state_.status == TrackStatus::NOT_INITIALIZED) return;
  ++state_.rejected_scans;
  state_.status = state_.rejected_scans >= options_.lost_after_scans ? TrackStatus::LOST : TrackStatus::COASTING;
}

Eigen::Isometry3d MotionPrediction::predict(double stamp_s) const {
  checkOption(std::isfinite(stamp_s), "stamp_s", stamp_s, "finite");
  if (state_.status == TrackStatus::NOT_INITIALIZED) {
    throw std::logic_error("no initial pose: setInitialPose() has not been called");
  }
  const double elapsed_s = elapsed(stamp_s);
  if (!state_.velocity_known || elapsed_s == 0.0) return state_.T_map_base;
  Eigen::Isometry3d T_last_next = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d turned = state_.turn_rate_base_radps * elapsed_s;
  T_last_next.translation() = meanRotation(turned) * state_.velocity_base_mps * elapsed_s;
  T_last_next.linear() = rotationFromVector(turned);
  return normalizedRotation(state_.T_map_base * T_last_next);
}

Matrix6d MotionPrediction::predictedCovariance(double stamp_s) const {
  checkOption(std::isfinite(stamp_s), "stamp_s", stamp_s, "finite");
  return propagated(elapsed(stamp_s)).topLeftCorner<6, 6>();
}

}  // namespace saw_ndt
