#pragma once

#include <cstddef>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {

/// Two stamps no farther apart than this are of the same scan.
constexpr double kStampTolerance_s = 0.01;

/// An estimated pose and the reference of the same scan, both in the map frame.
struct PosePair {
  double stamp_s = 0.0;  ///< of the estimate
  Eigen::Isometry3d T_map_reference = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_map_estimate = Eigen::Isometry3d::Identity();
};

/// Gives each estimated pose the reference pose nearest in time, in the order of the estimate's stamps.
///
/// Poses without a reference within kStampTolerance_s are left out, and so are those of the first `skip_s` seconds,
/// counted from the estimate's first stamp (a pose at exactly skip_s counts). Throws std::invalid_argument, saying why,
/// where no pair is left, where skip_s is negative, where a pose or stamp is not finite, and where poses of one
/// trajectory have the same stamp and are more than a centimetre apart.
SAW_NDT_EXPORT std::vector<PosePair> matchTrajectories(const std::vector<StampedPose>& reference,
                                                       const std::vector<StampedPose>& estimate, double skip_s);

/// How far a pose is off.
struct PoseError {
  double position_m = 0.0;  ///< distance to the reference position
  double yaw_deg = 0.0;     ///< difference of the headings, wrapped to +-180 degrees, without its sign
};
SAW_NDT_EXPORT PoseError poseError(const Eigen::Isometry3d& T_map_reference, const Eigen::Isometry3d& T_map_estimate);

/// Errors of an estimated trajectory in the frame of the map; nothing is aligned, for a localizer answers for the frame
/// as well. See PoseError.
struct TrajectoryMetrics {
  std::size_t evaluated_scans = 0;
  double ate_rmse_m = 0.0;  ///< absolute trajectory error: root of the mean squared position error
  double position_mean_m = 0.0;
  double position_median_m = 0.0;
  double position_p95_m = 0.0;
  double position_max_m = 0.0;
  double yaw_mae_deg = 0.0;  ///< mean absolute yaw error
  double yaw_p95_deg = 0.0;
};

/// The metrics of poses already matched. Throws std::invalid_argument where there is none.
SAW_NDT_EXPORT TrajectoryMetrics evaluatePosePairs(const std::vector<PosePair>& pairs);

/// The metrics of the poses that matchTrajectories() finds; it throws as that does.
SAW_NDT_EXPORT TrajectoryMetrics evaluateTrajectory(const std::vector<StampedPose>& reference,
                                                    const std::vector<StampedPose>& estimate, double skip_s);

}  // namespace saw_ndt
