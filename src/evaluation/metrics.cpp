#include "saw_ndt/evaluation/metrics.h"

#include <algorithm>
#include <cmath>

#include "saw_ndt/common/geometry.h"
#include "evaluation/statistics.h"

namespace saw_ndt {

TrajectoryMetrics evaluatePosePairs(const std::vector<PosePair>& pairs) {
  std::vector<double> position_errors_m;
  std::vector<double> squared_errors_m2;
  std::vector<double> yaw_errors_deg;
  for (const PosePair& pair : pairs) {
    const double error_m = (pair.T_map_estimate.translation() - pair.T_map_reference.translation()).norm();
    const double yaw_error = wrappedAngle(heading(pair.T_map_estimate) - heading(pair.T_map_reference));
    position_errors_m.push_back(error_m);
    squared_errors_m2.push_back(error_m * error_m);
    yaw_errors_deg.push_back(degreesFromRadians(std::abs(yaw_error)));
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
