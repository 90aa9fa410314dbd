#include "saw_ndt/localization/motion_prediction.h"

#include <cmath>
#include <stdexcept>

#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {
namespace {

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
  }
  return "unknown";
}

void MotionPredictionOptions::check() const {
  checkOption(max_speed_mps > 0.0 && std::isfinite(max_speed_mps), "max_speed_mps", max_speed_mps, "positive");
  checkOption(max_turn_rate_radps > 0.0 && std::isfinite(max_turn_rate_radps), "max_turn_rate_radps",
              max_turn_rate_radps, "positive");
}

MotionPrediction::MotionPrediction(const MotionPredictionOptions& options) : options_(options) { options_.check(); }

void MotionPrediction::reset(const Eigen::Isometry3d& T_map_base) {
  requireRigid(T_map_base, "T_map_base");
  state_ = TrackState();
  state_.status = TrackStatus::TRACKING;
  state_.T_map_base = T_map_base;
}

void MotionPrediction::accept(const Eigen::Isometry3d& T_map_base, double stamp_s) {
  requireRigid(T_map_base, "T_map_base");
  checkOption(std::isfinite(stamp_s), "stamp_s", stamp_s, "finite");
  TrackState next;
  next.status = TrackStatus::TRACKING;
  next.T_map_base = T_map_base;
  next.stamp_s = stamp_s;
  const double elapsed_s = state_.timeSinceLast(stamp_s).value_or(0.0);
  next.velocity_known = elapsed_s > 0.0;
  if (next.velocity_known) {
    const Eigen::Isometry3d T_last_now = state_.T_map_base.inverse() * T_map_base;
    const Eigen::Vector3d turned = rotationVector(T_last_now.linear());
    const Eigen::Vector3d driven = meanRotation(turned).inverse() * T_last_now.translation();
    next.velocity_base_mps = bounded(driven / elapsed_s, options_.max_speed_mps);
    next.turn_rate_base_radps = bounded(turned / elapsed_s, options_.max_turn_rate_radps);
  }
  state_ = next;
}

void MotionPrediction::reject() {
  if (state_.status == TrackStatus::NOT_INITIALIZED) return;
  state_.status = TrackStatus::COASTING;
  ++state_.rejected_scans;
}

Eigen::Isometry3d MotionPrediction::predict(double stamp_s) const {
  checkOption(std::isfinite(stamp_s), "stamp_s", stamp_s, "finite");
  if (state_.status == TrackStatus::NOT_INITIALIZED) {
    throw std::logic_error("no initial pose: setInitialPose() has not been called");
  }
  const double elapsed_s = state_.timeSinceLast(stamp_s).value_or(0.0);
  if (!state_.velocity_known || elapsed_s <= 0.0) return state_.T_map_base;
  Eigen::Isometry3d T_last_next = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d turned = state_.turn_rate_base_radps * elapsed_s;
  T_last_next.translation() = meanRotation(turned) * state_.velocity_base_mps * elapsed_s;
  T_last_next.linear() = rotationFromVector(turned);
  return normalizedRotation(state_.T_map_base * T_last_next);
}

}  // namespace saw_ndt
