#include "saw_ndt/evaluation/json.h"

#include <nlohmann/json.hpp>

namespace saw_ndt {

nlohmann::ordered_json toJson(const TrajectoryMetrics& metrics) {
  return {{"evaluated_scans", metrics.evaluated_scans}, {"ate_rmse_m", metrics.ate_rmse_m},
          {"position_mean_m", metrics.position_mean_m}, {"position_median_m", metrics.position_median_m},
          {"position_p95_m", metrics.position_p95_m},   {"position_max_m", metrics.position_max_m},
          {"yaw_mae_deg", metrics.yaw_mae_deg},         {"yaw_p95_deg", metrics.yaw_p95_deg}};
}

nlohmann::ordered_json toJson(const KittiRelativeErrors& errors) {
  return {{"kitti_segments", errors.segments},
          {"kitti_translation_percent", errors.translation_percent},
          {"kitti_rotation_deg_per_m", errors.rotation_deg_per_m}};
}

nlohmann::ordered_json toJson(const DurationStatistics& durations) {
  return {{"mean", durations.mean}, {"p50", durations.p50}, {"p95", durations.p95}, {"max", durations.max}};
}

}  // namespace saw_ndt
