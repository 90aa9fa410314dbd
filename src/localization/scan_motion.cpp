#include "localization/scan_motion.h"

#include <cmath>

namespace saw_ndt::internal {
namespace {

// Between poses farther apart in time the motion may have changed, and between closer ones it is mostly noise (s).
constexpr double kLongestInterval_s = 1.0;
constexpr double kShortestInterval_s = 0.01;

bool tellsMotion(double interval_s) { return interval_s >= kShortestInterval_s && interval_s <= kLongestInterval_s; }

}  // namespace

ScanTiming ScanMotion::begin(double stamp_s) {
  if (std::isfinite(stamp_s)) {
    stamp_before_s_ = stamp_s_;
    stamp_s_ = stamp_s;
    period_.add(stamp_s);
  }
  return {stamp_s, period_.seconds()};
}

BodyMotion ScanMotion::bounded(BodyMotion motion) const {
  const auto shorten = [](Eigen::Vector3d& vector, double limit) {
    if (vector.norm() > limit) vector *= limit / vector.norm();
  };
  shorten(motion.velocity_mps, limits_.max_speed_mps);
  shorten(motion.turn_rate_radps, limits_.max_turn_rate_radps);
  return motion;
}

std::optional<BodyMotion> ScanMotion::expected(const TrackState& track, const ScanPriors& priors) const {
  if (priors.motion && stamp_before_s_ && tellsMotion(*stamp_s_ - *stamp_before_s_)) {
    return bounded(motionBetween(priors.motion->T_before_now, *stamp_s_ - *stamp_before_s_));
  }
  if (track.velocity_known) return BodyMotion{track.velocity_base_mps, track.turn_rate_base_radps};
  if (learned_ && track.stamp_s == learned_->stamp_s && elapsed_s(track)) return learned_->motion;
  return std::nullopt;
}

std::optional<double> ScanMotion::elapsed_s(const TrackState& track) const {
  const bool was_found = track.velocity_known || track.status == TrackStatus::TRACKING;
  if (!stamp_s_) return std::nullopt;
  const std::optional<double> since_last_s = track.timeSinceLast(*stamp_s_);
  return was_found && since_last_s && tellsMotion(*since_last_s) ? since_last_s : std::nullopt;
}

std::optional<BodyMotion> ScanMotion::motionTo(const Eigen::Isometry3d& T_map_base, const TrackState& track) const {
  const std::optional<double> since_last_s = elapsed_s(track);
  if (!since_last_s) return std::nullopt;
  return bounded(motionBetween(track.T_map_base.inverse() * T_map_base, *since_last_s));
}

void ScanMotion::learn(const BodyMotion& motion) {
  if (stamp_s_) learned_ = LearnedMotion{*stamp_s_, motion};
}

}  // namespace saw_ndt::internal
