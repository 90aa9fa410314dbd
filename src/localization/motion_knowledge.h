#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "localization/motion_compensation.h"
#include "saw_ndt/localization/motion_prediction.h"
#include "saw_ndt/localization/scan_preparation.h"

namespace saw_ndt::internal {

/// What is known of the motion of a vehicle during the scans that follow it. From scan to scan a vehicle keeps its
/// velocity and turn rate in the plane that it stands on. How far it keeps those across it, which on a road are shocks,
/// is learned from their last correlations.
class MotionKnowledge {
 public:
  /// @param period_s  how long a turn of the LiDAR takes; 0: not known
  MotionKnowledge(const MotionPredictionOptions& limits, double period_s) : limits_(limits), period_(period_s) {}

  /// The next scan is taken at a stamp.
  ScanTiming begin(double stamp_s);
  /// Another vehicle, or another place: what was learned of the motion does not hold any more.
  void forget();

  /// The motion during the scan of begin(): of odometry where that is given, else of the track, else what was learned
  /// at its last pose.
  std::optional<ScanMotion> expected(const TrackState& track, const ScanPriors& priors) const;
  /// The motion that leads from the last pose of a track to one of the scan of begin(), and from there on. Nothing
  /// where they are too far apart in time, or there is no last pose that was found.
  std::optional<ScanMotion> motionTo(const Eigen::Isometry3d& T_map_base, const TrackState& track) const;
  /// From the last pose of a track to the scan of begin() (s), where motionTo() tells.
  std::optional<double> elapsed_s(const TrackState& track) const;

  /// The scan of begin() was accepted as taken in this motion.
  void learn(const ScanMotion& motion);

 private:
  BodyMotion bounded(BodyMotion motion) const;
  ScanMotion continued(const BodyMotion& motion) const;

  struct LearnedMotion {
    double stamp_s;
    BodyMotion motion;
  };
  /// Running sums of what moves across the plane: of its square, and of its product with that a scan before.
  struct Persistence {
    double square = 0.0;
    double product = 0.0;

    void add(double new_square, double new_product);
    /// 0: what comes next has nothing to do with it, to 1: it lasts.
    double share() const;
  };

  MotionPredictionOptions limits_;
  ScanPeriod period_;
  std::optional<double> stamp_s_;
  std::optional<double> stamp_before_s_;
  std::optional<LearnedMotion> learned_;
  Persistence of_heave_;
  Persistence of_tilt_;
};

}  // namespace saw_ndt::internal
