#pragma once

#include "saw_ndt/common/export.h"
#include "saw_ndt/localization/track_state.h"
#include "saw_ndt/registration/alignment.h"

namespace saw_ndt {

struct SAW_NDT_EXPORT MotionPredictionOptions {
  double max_speed_mps = 60.0;       ///< a predicted speed is cut to this (m/s)
  double max_turn_rate_radps = 1.5;  ///< a predicted turn rate is cut to this (rad/s)
  /// What a vehicle does that a constant velocity does not foresee, one sigma: accelerations (m/s^2) that last.
  double acceleration_sigma_mps2 = 3.0;
  double turn_acceleration_sigma_radps2 = 0.5;  ///< the same of turns (rad/s^2)
  double unknown_speed_sigma_mps = 15.0;        ///< of the velocity while none is known, one sigma (m/s)
  double initial_sigma_m = 20.0;                ///< of the position of an initial pose (m)
  double initial_sigma_deg = 30.0;              ///< of its rotation (degrees); above 30 it may look the other way
  double max_extrapolation_s = 15.0;            ///< after a longer time the motion is unknown again (s)
  int lost_after_scans = 3;                     ///< rejected one after the other, 1 or more

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// A pose that has been found, and how sure it is.
struct MeasuredPose {
  Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();                 ///< as AlignmentResult::covariance
  PoseDirections free_directions = PoseDirections(6, 0);  ///< as AlignmentResult::free_directions
  bool learn_velocity = true;                             ///< false: the motion that led here is not to be believed
  std::optional<double> overlap = {};                     ///< AlignmentResult::overlap, where it is known
};

/// The motion of the base from one scan to the next, as odometry measures it.
struct MeasuredMotion {
  Eigen::Isometry3d T_before_now = Eigen::Isometry3d::Identity();  ///< pose of the base in the base's frame before
  /// By (translation, rotation) in the axes of the base before. Errors of successive motions may be alike, as those of
  /// a drift: their standard deviations are added, not their variances.
  Matrix6d covariance = Matrix6d::Zero();
};

/// A position of the base, as GNSS measures it.
struct MeasuredPosition {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< in the map
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< m^2
};

/// What other sensors measured of a scan's pose, as far as there are any.
struct ScanPriors {
  std::optional<MeasuredMotion> motion;  ///< since the scan before, accepted or not
  std::optional<MeasuredPosition> position;
};

/// A pose and how sure it is.
struct UncertainPose {
  Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();  ///< as AlignmentResult::covariance
};

/// Follows the track of a vehicle: predicts its next pose from the last two accepted ones and their stamps (Section
/// III.C of the paper), by constant velocity and turn rate in the vehicle's own frame, a circle where it turns, both
/// bounded. Before there are two, the last pose. Beside the pose it carries the covariance of pose and velocity, that
/// of just this estimator: free directions keep the prediction and its growing uncertainty, and an acceleration of
/// unknown size is reckoned with but not estimated (a "consider" state). Stamps may be wrong: after a gap, and where
/// they do not grow, the covariance holds the motion of half the time more or less. Not to be shared by threads.
class SAW_NDT_EXPORT MotionPrediction {
 public:
  explicit MotionPrediction(const MotionPredictionOptions& options = {});

  /// Forgets all poses and starts from one whose stamp is not known.
  /// @throws std::invalid_argument unless it is a finite rigid transform
  void reset(const Eigen::Isometry3d& T_map_base);
  /// Forgets all poses: the vehicle is lost, and may be anywhere.
  void resetUnknown();
  /// Goes on from a pose that was found without regard to the motion before, as after a kidnapping: nothing is known of
  /// the velocity. Returns its covariance. @throws std::invalid_argument for what is not finite
  Matrix6d restart(const MeasuredPose& pose, double stamp_s);
  /// Adds an accepted pose and returns its covariance, as TrackState::covariance. A scan whose stamp (s) is not after
  /// the last comes late and adds nothing, unless it is more than a second before it, where it could not have been
  /// then, or the third in a row: then the clock was set back.
  /// @throws std::invalid_argument for what is not finite
  Matrix6d accept(const MeasuredPose& pose, double stamp_s);
  /// The same of a pose that is exact.
  Matrix6d accept(const Eigen::Isometry3d& T_map_base, double stamp_s) {
    return accept(MeasuredPose{T_map_base}, stamp_s);
  }
  /// The motion since the scan before, accepted or not. Call it for each scan, before what is asked or told of it;
  /// nothing where it was not measured. As long as it is known from the last pose on, predictions follow it instead of
  /// a constant velocity, and stamps do not matter.
  void move(const std::optional<MeasuredMotion>& motion);
  /// Corrects the last accepted pose, and the velocity, by a position measured then, as far as that is surer. What does
  /// not fit what is known is passed over as an outlier. Returns the covariance of the pose.
  Matrix6d correct(const MeasuredPosition& position);
  /// A scan was rejected: nothing new is known. An initial pose is that of the first scan, rejected or not.
  /// @param searched  the scan was looked for in all of the map
  void reject(double stamp_s, bool searched = false);

  /// The pose expected at a stamp, which may be up to a second before the last.
  /// @throws std::invalid_argument for a stamp that is not finite, std::logic_error before reset() or accept()
  Eigen::Isometry3d predict(double stamp_s) const;
  /// Its covariance, as AlignmentResult::covariance. @throws as predict()
  Matrix6d predictedCovariance(double stamp_s) const;
  /// Whether a pose is where the vehicle cannot well have come by then, if the stamp is true.
  bool isSurprising(const MeasuredPose& pose, double stamp_s) const;

  const TrackState& state() const { return state_; }

 private:
  /// Errors of the pose, of velocity and turn rate, and of the accelerations, in the axes of the map.
  using Covariance = Eigen::Matrix<double, 18, 18>;

  struct Interval;

  Interval intervalTo(double stamp_s) const;
  Covariance propagated(const Interval& interval) const;
  /// Whether a scan was taken before the last one. Too many of them show a clock that was set back instead.
  bool comesLate(const Interval& interval);
  /// Sets the velocities of the state and returns what errors of the pose do to them.
  Matrix6d learnVelocity(const MeasuredPose& pose, double stamp_s, const Covariance& predicted);

  MotionPredictionOptions options_;
  std::optional<MeasuredMotion> motion_;  // since the last pose
  bool motion_complete_ = true;           // no scan since then was without
  TrackState state_;
  Covariance covariance_ = Covariance::Zero();
  int late_scans_ = 0;  // one after the other
};

/// An aligned pose with what it does not tell taken from the predicted one: free directions keep the prediction
/// (solution remapping, Zhang, Kaess and Singh 2016).
SAW_NDT_EXPORT Eigen::Isometry3d keptAlongFreeDirections(const Eigen::Isometry3d& T_map_predicted,
                                                         const Eigen::Isometry3d& T_map_aligned,
                                                         const PoseDirections& free_directions);

/// The error of a pose by (translation, rotation), in the axes of the map: it turns and moves `from` to `to`.
SAW_NDT_EXPORT Vector6d poseDifference(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to);

/// A pose corrected by a position that was measured of it (Kalman filter); nothing where the position is an outlier:
/// farther away than both allow but once in a thousand times.
SAW_NDT_EXPORT std::optional<UncertainPose> correctedBy(const MeasuredPosition& position, const UncertainPose& pose);

/// That of a pose of which nothing is known: standard deviations of 100 km and of half a turn.
SAW_NDT_EXPORT Matrix6d anywhereCovariance();

/// Whether chance makes an error of that covariance so large less than once in a thousand times (a squared Mahalanobis
/// distance of 22.5).
SAW_NDT_EXPORT bool isUnlikely(const Vector6d& error, const Matrix6d& covariance);

}  // namespace saw_ndt
