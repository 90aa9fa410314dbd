#include "saw_ndt/evaluation/metrics.h"

#include <algorithm>
#include <cmath>

#include "evaluation/statistics.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {

using namespace internal;

PoseError poseError(const Eigen::Isometry3d& T_map_reference, const Eigen::Isometry3d& T_map_estimate) {
  return {(T_map_estimate.translation() - T_map_reference.translation()).norm(),
          degreesFromRadians(std::abs(wrappedAngle(heading(T_map_estimate) - heading(T_map_reference))))};
}

TrajectoryMetrics evaluatePosePairs(const std::vector<PosePair>& pairs) {
  std::vector<double> position_errors_m;
  std::vector<double> squared_errors_m2;
  std::vector<double> yaw_errors_deg;
  for (const PosePair& pair : pairs) {
    const PoseError error = poseError(pair.T_map_reference, pair.T_map_estimate);
    position_errors_m.push_back(error.position_m);
    squared_errors_m2.push_back(error.position_m * error.position_m);
    yaw_errors_deg.push_back(error.yaw_deg);
  }
  TrajectoryMetrics metrics;
  metrics.evaluated_scans = pairs.size();
  metrics.ate_rmse_m = std::sqrt(mean(squared_errors_m2));
  metrics.position_mean_m = mean(position_errors_m);
  metrics.position_median_m = median(position_errors_m);
  metrics.position_p95_m = percentile(position_errors_m, 95.0);
  metrics.position_max_m = *std::max_element(position_errors_m.begin(), position_errors_m.end());
  metrics.yaw_mae_deg = mean(yaw_errors_deg);
  metrics.yaw_p95_deg = percentile(yaw_errors_deg, 95.0);
  return metrics;
}

TrajectoryMetrics evaluateTrajectory(const std::vector<StampedPose>& reference,
                                     const std::vector<StampedPose>& estimate, double skip_s) {
  return evaluatePosePairs(matchTrajectories(reference, estimate, skip_s));
}

}  // namespace saw_ndt
