#pragma once

#include "saw_ndt/common/export.h"
#include "saw_ndt/localization/track_state.h"

namespace saw_ndt {

struct SAW_NDT_EXPORT MotionPredictionOptions {
  double max_speed_mps = 60.0;       ///< a predicted speed is cut to this (m/s)
  double max_turn_rate_radps = 1.5;  ///< a predicted turn rate is cut to this (rad/s)

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// Follows the track of a vehicle: predicts its next pose from the last two accepted ones and their stamps (Section
/// III.C of the paper), by constant velocity and turn rate in the vehicle's own frame, a circle where it turns, both
/// bounded. Before there are two, the last pose.
class SAW_NDT_EXPORT MotionPrediction {
 public:
  explicit MotionPrediction(const MotionPredictionOptions& options = {});

  /// Forgets all poses and starts from one whose stamp is not known.
  /// @throws std::invalid_argument unless it is a finite rigid transform
  void reset(const Eigen::Isometry3d& T_map_base);
  /// Adds an accepted pose. Stamps (s) that do not grow leave the velocity unknown.
  /// @throws std::invalid_argument for what is not finite
  void accept(const Eigen::Isometry3d& T_map_base, double stamp_s);
  /// A scan was rejected: nothing new is known.
  void reject();

  /// The pose expected at a stamp.
  /// @throws std::invalid_argument for a stamp that is not finite, std::logic_error before reset() or accept()
  Eigen::Isometry3d predict(double stamp_s) const;

  const TrackState& state() const { return state_; }

 private:
  MotionPredictionOptions options_;
  TrackState state_;
};

}  // namespace saw_ndt
