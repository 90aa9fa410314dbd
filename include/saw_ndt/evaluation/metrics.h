#pragma once

#include <cstddef>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/evaluation/pose_pairs.h"

namespace saw_ndt {

/// How far a pose is off.
struct PoseError {
  double position_m = 0.0;  ///< distance to the reference position
  double yaw_deg = 0.0;     ///< difference of the headings, wrapped to +-180 degrees, without its sign
};
SAW_NDT_EXPORT PoseError poseError(const Eigen::Isometry3d& T_map_reference, const Eigen::Isometry3d& T_map_estimate);

/// Errors of an estimated trajectory in the frame of the map. Nothing is aligned, for a localizer answers for the frame
/// as well; alignedPairs() does it for those who do not. See PoseError.
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
