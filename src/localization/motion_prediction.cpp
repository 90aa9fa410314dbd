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

void requireFinite(const Eigen::Isometry3d& T_map_base) {
  if (!T_map_base.matrix().allFinite()) throw std::invalid_argument("T_map_base: must be finite");
}

}  // namespace

void MotionPredictionOptions::check() const {
  checkOption(max_speed_mps > 0.0 && std::isfinite(max_speed_mps), "max_speed_mps", max_speed_mps, "positive");
  checkOption(max_turn_rate_radps > 0.0 && std::isfinite(max_turn_rate_radps), "max_turn_rate_radps",
              max_turn_rate_radps, "positive");
}

MotionPrediction::MotionPrediction(const MotionPredictionOptions& options) : options_(options) { options_.check(); }

void MotionPrediction::reset(const Eigen::Isometry3d& T_map_base) {
  requireFinite(T_map_base);
  T_map_last_ = T_map_base;
  last_stamp_s_.reset();
  velocity_known_ = false;
}

void MotionPrediction::accept(const Eigen::Isometry3d& T_map_base, double stamp_s) {
  requireFinite(T_map_base);
  checkOption(std::isfinite(stamp_s), "stamp_s", stamp_s, "finite");
  const double elapsed_s = last_stamp_s_ ? stamp_s - *last_stamp_s_ : 0.0;
  velocity_known_ = elapsed_s > 0.0;
  if (velocity_known_) {
    const Eigen::Isometry3d T_last_now = T_map_last_.inverse() * T_map_base;
    const Eigen::Vector3d turned = rotationVector(T_last_now.linear());
    const Eigen::Vector3d driven = meanRotation(turned).inverse() * T_last_now.translation();
    velocity_base_mps_ = bounded(driven / elapsed_s, options_.max_speed_mps);
    turn_rate_base_radps_ = bounded(turned / elapsed_s, options_.max_turn_rate_radps);
  }
  T_map_last_ = T_map_base;
  last_stamp_s_ = stamp_s;
}

Eigen::Isometry3d MotionPrediction::predict(double stamp_s) const {
  checkOption(std::isfinite(stamp_s), "stamp_s", stamp_s, "finite");
  const double elapsed_s = timeSinceLast(stamp_s).value_or(0.0);
  if (!velocity_known_ || elapsed_s <= 0.0) return T_map_last_;
  Eigen::Isometry3d T_last_next = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d turned = turn_rate_base_radps_ * elapsed_s;
  T_last_next.translation() = meanRotation(turned) * velocity_base_mps_ * elapsed_s;
  T_last_next.linear() = rotationFromVector(turned);
  return normalizedRotation(T_map_last_ * T_last_next);
}

std::optional<double> MotionPrediction::timeSinceLast(double stamp_s) const {
  if (!last_stamp_s_) return std::nullopt;
  return stamp_s - *last_stamp_s_;
}

}  // namespace saw_ndt
