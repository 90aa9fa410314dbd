#include "report/json.h"

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

nlohmann::ordered_json toJson(const ErrorStatistics& statistics) {
  return {{"rmse", statistics.rmse}, {"mean", statistics.mean}, {"median", statistics.median}, {"std", statistics.std},
          {"min", statistics.min},   {"max", statistics.max},   {"sse", statistics.sse}};
}

nlohmann::ordered_json toJson(const PoseErrorStatistics& statistics, const std::string& prefix) {
  nlohmann::ordered_json json;
  json[prefix + "translation_m"] = toJson(statistics.translation_m);
  json[prefix + "rotation_deg"] = toJson(statistics.rotation_deg);
  json[prefix + "full"] = toJson(statistics.full);
  return json;
}

nlohmann::ordered_json toJson(const internal::DurationStatistics& durations) {
  return {{"mean", durations.mean}, {"p50", durations.p50}, {"p95", durations.p95}, {"max", durations.max}};
}

nlohmann::ordered_json toJson(const StateShare& share) { return {{"scans", share.scans}, {"seconds", share.seconds}}; }

nlohmann::ordered_json toJson(const TileLoads& loads) {
  nlohmann::ordered_json json = {{"loads", loads.loads},
                                 {"wide_loads", loads.wide_loads},
                                 {"waits", loads.waits},
                                 {"longest_wait_ms", loads.longest_wait_ms},
                                 {"first_load_ms", loads.first_load_ms},
                                 {"longest_load_ms", loads.longest_load_ms}};
  if (loads.least_radius_m > 0.0) json["least_radius_m"] = loads.least_radius_m;
  return json;
}

nlohmann::ordered_json toJson(const LocalizationSummary& summary) {
  nlohmann::ordered_json json;
  json["method"] = summary.method;
  json["scans"] = summary.scans;
  json["accepted"] = summary.accepted;
  json["rejected"] = summary.rejected;
  if (summary.left_out) json["left_out"] = *summary.left_out;
  json["states"] = {{"tracking", toJson(summary.tracking)},
                    {"coasting", toJson(summary.coasting)},
                    {"relocalizing", toJson(summary.relocalizing)},
                    {"lost", toJson(summary.lost)}};
  json["recoveries"] = summary.recoveries;
  json["degenerate_scans"] = summary.degenerate_scans;
  json["total_ms"] = toJson(summary.total_ms);
  json["segment_ms"] = toJson(summary.segment_ms);
  json["filter_ms"] = toJson(summary.filter_ms);
  json["align_ms"] = toJson(summary.align_ms);
  json["source_points_mean"] = summary.source_points_mean;
  json["iterations_mean"] = summary.iterations_mean;
  json["evaluations_mean"] = summary.evaluations_mean;
  json["likelihood_mean"] = summary.likelihood_mean;
  json["nearest_voxel_likelihood_mean"] = summary.nearest_voxel_likelihood_mean;
  json["non_ground_likelihood_mean"] = summary.non_ground_likelihood_mean;
  json["peak_rss_mb"] = summary.peak_rss_mb;
  json["threads"] = summary.threads;
  json["motion_compensation"] = toString(summary.motion_compensation);
  if (summary.tiles) json["tiles"] = toJson(*summary.tiles);
  if (!summary.motion_compensation_reason.empty()) {
    json["motion_compensation_reason"] = summary.motion_compensation_reason;
  }
  if (summary.metrics) json.update(toJson(*summary.metrics));
  return json;
}

}  // namespace saw_ndt
