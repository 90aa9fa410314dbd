#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "localization/motion_compensation.h"
#include "localization/motion_refinement.h"
#include "saw_ndt/localization/motion_prediction.h"
#include "saw_ndt/localization/scan_preparation.h"

namespace saw_ndt::internal {

/// What is known of the motion of a vehicle during the scans that follow it.
class MotionKnowledge {
 public:
  /// @param period_s  how long a turn of the LiDAR takes; 0: not known
  MotionKnowledge(const MotionPredictionOptions& limits, double period_s) : limits_(limits), period_(period_s) {}

  /// The next scan is taken at a stamp.
  ScanTiming begin(double stamp_s);
  /// Another vehicle, or another place: what was learned of the motion does not hold any more.
  void forget() { learned_.reset(); }

  /// The motion during the scan of begin(): of odometry where that is given, else of the track, else what was learned
  /// at its last pose.
  std::optional<ScanMotion> expected(const TrackState& track, const ScanPriors& priors) const;
  /// What the motion follows from when the pose is found.
  /// @param is_elsewhere  the track before does not lead to this scan
  MotionPrior prior(const TrackState& track, const ScanPriors& priors, bool is_elsewhere) const;

  /// The scan of begin() was accepted as taken in this motion.
  void learn(const ScanMotion& motion);

 private:
  std::optional<BodyMotion> measured(const ScanPriors& priors) const;
  // From the last pose of a track to the scan of begin() (s), where that tells the motion between them.
  std::optional<double> sinceLast_s(const TrackState& track) const;

  struct LearnedMotion {
    double stamp_s;
    BodyMotion motion;
  };

  MotionPredictionOptions limits_;
  ScanPeriod period_;
  std::optional<double> stamp_s_;
  std::optional<double> stamp_before_s_;
  std::optional<LearnedMotion> learned_;
};

}  // namespace saw_ndt::internal
