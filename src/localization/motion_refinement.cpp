#include "localization/motion_refinement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "saw_ndt/common/geometry.h"

namespace saw_ndt::internal {
namespace {

constexpr int kMostEvaluations = 25;

// A step that moves no point of the scan farther is the last one (m); see shiftBetween().
constexpr double kSettledShift_m = 2e-3;

// The squared Mahalanobis distance that chance passes once in a thousand times, of six numbers.
constexpr double kUnlikely = 22.5;

// What turns directions of the base into those of the map, for velocity and turn rate.
Matrix6d turned(const Eigen::Matrix3d& R_map_base) {
  Matrix6d result = Matrix6d::Zero();
  result.topLeftCorner<3, 3>() = result.bottomRightCorner<3, 3>() = R_map_base;
  return result;
}

Vector6d planarMask() { return (Vector6d() << 1, 1, 0, 0, 0, 1).finished(); }

Vector6d ratesOf(const BodyMotion& motion) {
  return (Vector6d() << motion.velocity_mps, motion.turn_rate_radps).finished();
}

BodyMotion motionOf(const Vector6d& rates) { return {rates.head<3>(), rates.tail<3>()}; }

}  // namespace

BodyMotion planarPart(const BodyMotion& motion) { return motionOf(planarMask().cwiseProduct(ratesOf(motion))); }

ScanMotion MotionPrior::motionTo(const Eigen::Isometry3d& T_map_base, const Vector6d& change) const {
  if (!tellsBefore()) return ScanMotion::even(motionOf(change));
  const BodyMotion until = before ? *before : motionBetween(T_map_base_last->inverse() * T_map_base, since_last_s);
  return {until, motionOf(ratesOf(planarPart(until)) + change)};
}

void MotionRefinement::divide(const MovingSource& moving) {
  const SourcePoints& source = moving.measured();
  const std::vector<float>& times_s = moving.times_s();
  const auto [first, last] = std::minmax_element(times_s.begin(), times_s.end());
  // No part has times of both signs: the motion changes at the stamp.
  const auto partOf = [earliest = *first, latest = *last](float time_s) {
    constexpr auto kHalf = static_cast<int>(kParts / 2);
    const float share = time_s < 0.0F ? 1.0F - time_s / earliest : time_s / std::max(latest, 1e-9F);
    const int within = std::clamp(static_cast<int>(share * static_cast<float>(kHalf)), 0, kHalf - 1);
    return static_cast<std::size_t>(time_s < 0.0F ? within : kHalf + within);
  };
  for (Part& part : parts_) {
    part.measured.clear();
    part.measured.labelled = source.labelled;
    part.times_s.clear();
    part.mean_time_s = 0.0;
  }
  for (std::size_t i = 0; i < source.size(); ++i) {
    Part& part = parts_[partOf(times_s[i])];
    part.measured.add(source.x[i], source.y[i], source.z[i], static_cast<StructuralLabel>(source.label[i]));
    part.times_s.push_back(times_s[i]);
    part.mean_time_s += static_cast<double>(times_s[i]);
  }
  for (Part& part : parts_) {
    if (!part.measured.empty()) part.mean_time_s /= static_cast<double>(part.measured.size());
    part.moved.label = part.measured.label;
    part.moved.labelled = part.measured.labelled;
  }
}

void MotionRefinement::evaluate(const MotionPrior& prior, State& state) {
  const ScanMotion motion = prior.motionTo(state.T_map_base, state.change);
  const Matrix6d R = turned(state.T_map_base.linear());
  const Matrix6d planar = R * planarMask().asDiagonal() * R.transpose();
  state.score = 0.0;
  state.gradient.setZero();
  state.curvature.setZero();
  state.pair_count = 0;
  for (Part& part : parts_) {
    if (part.measured.empty()) continue;
    compensate(part.measured, part.times_s, motion, part.moved);
    part.evaluation.begin(target_, part.moved, options_);
    const NdtDerivatives at = part.evaluation.onMatchingLevels(state.T_map_base)(state.T_map_base);
    // How the pose at which a point of this part was seen changes with pose and motion.
    const double t = part.mean_time_s;
    Eigen::Matrix<double, 6, 12> J;
    J.leftCols<6>().setIdentity();
    if (!prior.before && prior.T_map_base_last) {
      J.leftCols<6>() += t / prior.since_last_s * (t < 0.0 ? Matrix6d(Matrix6d::Identity()) : planar);
    }
    const bool is_changed = t >= 0.0 || !prior.tellsBefore();
    J.rightCols<6>() = is_changed ? Matrix6d(t * R) : Matrix6d(Matrix6d::Zero());
    state.score += at.score;
    state.gradient += J.transpose() * at.gradient();
    state.curvature += J.transpose() * at.curvature * J;
    state.pair_count += at.pair_count;
  }
  const Vector6d weights = options_.covariance_scale * prior.sigmas.cwiseAbs2().cwiseInverse();
  state.score -= 0.5 * weights.dot(state.change.cwiseAbs2());
  state.gradient.tail<6>() -= weights.cwiseProduct(state.change);
  state.curvature.bottomRightCorner<6, 6>().diagonal() += weights;
}

std::optional<RefinedMotion> MotionRefinement::refine(const NdtTarget& target, const MovingSource& source,
                                                      const Eigen::Isometry3d& T_map_base, const ScanMotion& motion,
                                                      const MotionPrior& prior) {
  target_ = target;
  divide(source);
  State best;
  best.T_map_base = T_map_base;
  best.change = ratesOf(motion.after) - ratesOf(prior.motionTo(T_map_base, Vector6d::Zero()).after);
  evaluate(prior, best);
  if (best.pair_count == 0) return std::nullopt;
  const auto stepFrom = [](const State& at) {
    Matrix12d curvature = at.curvature;
    curvature.diagonal().array() *= 1.0 + 1e-9;
    return Vector12d(curvature.ldlt().solve(at.gradient));
  };
  Vector12d step = stepFrom(best);
  for (int evaluation = 1; evaluation < kMostEvaluations && step.allFinite(); ++evaluation) {
    State trial;
    trial.T_map_base = best.T_map_base;
    trial.T_map_base.translation() += step.head<3>();
    trial.T_map_base.linear() = rotationFromVector(step.segment<3>(3)) * best.T_map_base.linear();
    trial.T_map_base = normalizedRotation(trial.T_map_base);
    trial.change = best.change + step.tail<6>();
    evaluate(prior, trial);
    const bool is_better = trial.score > best.score;
    const double shift_m = step.head<3>().norm() + kShiftArm_m * step.segment<3>(3).norm() +
                           source.reach_s() * (step.segment<3>(6).norm() + kShiftArm_m * step.tail<3>().norm());
    if (is_better) {
      best = trial;
      step = stepFrom(best);
    } else {
      step *= 0.5;
    }
    if (shift_m < kSettledShift_m) break;
  }
  RefinedMotion refined;
  refined.T_map_base = best.T_map_base;
  refined.motion = prior.motionTo(best.T_map_base, best.change);
  const Matrix12d covariance = options_.covariance_scale * best.curvature.inverse();
  const Vector6d rates = ratesOf(refined.motion.after);
  refined.significant = rates.dot(covariance.bottomRightCorner<6, 6>().ldlt().solve(rates)) > kUnlikely;
  return refined;
}

}  // namespace saw_ndt::internal
