#include "localization/motion_knowledge.h"

#include <cmath>

namespace saw_ndt::internal {
namespace {

// Between poses farther apart in time the motion may have changed, and between closer ones it is mostly noise (s).
constexpr double kLongestInterval_s = 1.0;
constexpr double kShortestInterval_s = 0.01;

bool tellsMotion(double interval_s) { return interval_s >= kShortestInterval_s && interval_s <= kLongestInterval_s; }

// How the motion behind the stamp differs from that before it, one sigma (m/s, rad/s): the vehicle brakes, turns in and
// is shaken by the road.
Vector6d changeSigmas() { return (Vector6d() << 0.5, 0.3, 0.5, 0.1, 0.1, 0.1).finished(); }

}  // namespace

ScanTiming MotionKnowledge::begin(double stamp_s) {
  if (std::isfinite(stamp_s)) {
    stamp_before_s_ = stamp_s_;
    stamp_s_ = stamp_s;
    period_.add(stamp_s);
  }
  return {stamp_s, period_.seconds()};
}

std::optional<BodyMotion> MotionKnowledge::measured(const ScanPriors& priors) const {
  if (!priors.motion || !stamp_before_s_ || !tellsMotion(*stamp_s_ - *stamp_before_s_)) return std::nullopt;
  return motionBetween(priors.motion->T_before_now, *stamp_s_ - *stamp_before_s_);
}

std::optional<double> MotionKnowledge::sinceLast_s(const TrackState& track) const {
  const bool was_found = track.velocity_known || track.status == TrackStatus::TRACKING;
  if (!stamp_s_ || !was_found) return std::nullopt;
  const std::optional<double> since_last_s = track.timeSinceLast(*stamp_s_);
  return since_last_s && tellsMotion(*since_last_s) ? since_last_s : std::nullopt;
}

std::optional<ScanMotion> MotionKnowledge::expected(const TrackState& track, const ScanPriors& priors) const {
  if (const auto motion = measured(priors)) return ScanMotion{*motion, planarPart(*motion)};
  if (track.velocity_known) {
    return ScanMotion::even(planarPart({track.velocity_base_mps, track.turn_rate_base_radps}));
  }
  if (learned_ && track.stamp_s == learned_->stamp_s && sinceLast_s(track)) {
    return ScanMotion::even(planarPart(learned_->motion));
  }
  return std::nullopt;
}

MotionPrior MotionKnowledge::prior(const TrackState& track, const ScanPriors& priors, bool is_elsewhere) const {
  MotionPrior prior;
  prior.sigmas = changeSigmas();
  prior.before = measured(priors);
  if (prior.before) return prior;
  if (const auto since_last_s = sinceLast_s(track); since_last_s && !is_elsewhere) {
    prior.T_map_base_last = track.T_map_base;
    prior.since_last_s = *since_last_s;
    return prior;
  }
  prior.sigmas << limits_.unknown_speed_sigma_mps, 1.0, 0.5, 0.1, 0.1, limits_.max_turn_rate_radps / 3.0;
  return prior;
}

void MotionKnowledge::learn(const ScanMotion& motion) {
  if (stamp_s_) learned_ = LearnedMotion{*stamp_s_, motion.after};
}

}  // namespace saw_ndt::internal
