#include "localization/motion_knowledge.h"

#include <algorithm>
#include <cmath>

namespace saw_ndt::internal {
namespace {

// Between poses farther apart in time the motion may have changed, and between closer ones it is mostly noise (s).
constexpr double kLongestInterval_s = 1.0;
constexpr double kShortestInterval_s = 0.01;

// Adding up the recent past of the persistence.
constexpr double kOldShare = 0.9;

bool tellsMotion(double interval_s) { return interval_s >= kShortestInterval_s && interval_s <= kLongestInterval_s; }

}  // namespace

ScanTiming MotionKnowledge::begin(double stamp_s) {
  if (std::isfinite(stamp_s)) {
    stamp_before_s_ = stamp_s_;
    stamp_s_ = stamp_s;
    period_.add(stamp_s);
  }
  return {stamp_s, period_.seconds()};
}

BodyMotion MotionKnowledge::bounded(BodyMotion motion) const {
  const auto shorten = [](Eigen::Vector3d& vector, double limit) {
    if (vector.norm() > limit) vector *= limit / vector.norm();
  };
  shorten(motion.velocity_mps, limits_.max_speed_mps);
  shorten(motion.turn_rate_radps, limits_.max_turn_rate_radps);
  return motion;
}

void MotionKnowledge::forget() {
  learned_.reset();
  of_heave_ = of_tilt_ = Persistence();
}

void MotionKnowledge::Persistence::add(double new_square, double new_product) {
  square = kOldShare * square + new_square;
  product = kOldShare * product + new_product;
}

double MotionKnowledge::Persistence::share() const {
  return square > 0.0 ? std::clamp(product / square, 0.0, 1.0) : 0.0;
}

ScanMotion MotionKnowledge::continued(const BodyMotion& motion) const {
  BodyMotion after = motion;
  after.velocity_mps.z() *= of_heave_.share();
  after.turn_rate_radps.head<2>() *= of_tilt_.share();
  return {motion, after};
}

std::optional<ScanMotion> MotionKnowledge::expected(const TrackState& track, const ScanPriors& priors) const {
  if (priors.motion && stamp_before_s_ && tellsMotion(*stamp_s_ - *stamp_before_s_)) {
    return continued(bounded(motionBetween(priors.motion->T_before_now, *stamp_s_ - *stamp_before_s_)));
  }
  if (track.velocity_known) {
    return ScanMotion::even(continued({track.velocity_base_mps, track.turn_rate_base_radps}).after);
  }
  if (learned_ && track.stamp_s == learned_->stamp_s && elapsed_s(track)) {
    return ScanMotion::even(continued(learned_->motion).after);
  }
  return std::nullopt;
}

std::optional<double> MotionKnowledge::elapsed_s(const TrackState& track) const {
  const bool was_found = track.velocity_known || track.status == TrackStatus::TRACKING;
  if (!stamp_s_) return std::nullopt;
  const std::optional<double> since_last_s = track.timeSinceLast(*stamp_s_);
  return was_found && since_last_s && tellsMotion(*since_last_s) ? since_last_s : std::nullopt;
}

std::optional<ScanMotion> MotionKnowledge::motionTo(const Eigen::Isometry3d& T_map_base,
                                                    const TrackState& track) const {
  const std::optional<double> since_last_s = elapsed_s(track);
  if (!since_last_s) return std::nullopt;
  return continued(bounded(motionBetween(track.T_map_base.inverse() * T_map_base, *since_last_s)));
}

void MotionKnowledge::learn(const ScanMotion& motion) {
  const BodyMotion& now = motion.before;
  if (learned_) {
    const BodyMotion& last = learned_->motion;
    of_heave_.add(last.velocity_mps.z() * last.velocity_mps.z(), now.velocity_mps.z() * last.velocity_mps.z());
    of_tilt_.add(last.turn_rate_radps.head<2>().squaredNorm(),
                 now.turn_rate_radps.head<2>().dot(last.turn_rate_radps.head<2>()));
  }
  if (stamp_s_) learned_ = LearnedMotion{*stamp_s_, now};
}

}  // namespace saw_ndt::internal
