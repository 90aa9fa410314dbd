#include "report/json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace saw_ndt {
namespace {

TEST(Json, HasTheNamesOfTheFieldsInTheirOrder) {
  TrajectoryMetrics metrics;
  metrics.evaluated_scans = 3;
  metrics.ate_rmse_m = 0.25;
  EXPECT_EQ(toJson(metrics).dump(),
            R"({"evaluated_scans":3,"ate_rmse_m":0.25,"position_mean_m":0.0,"position_median_m":0.0,)"
            R"("position_p95_m":0.0,"position_max_m":0.0,"yaw_mae_deg":0.0,"yaw_p95_deg":0.0})");
  EXPECT_EQ(toJson(internal::DurationStatistics{1.0, 2.0, 3.0, 4.5}).dump(),
            R"({"mean":1.0,"p50":2.0,"p95":3.0,"max":4.5})");
  EXPECT_EQ(toJson(KittiRelativeErrors{2, 0.5, 0.125}).dump(),
            R"({"kitti_segments":2,"kitti_translation_percent":0.5,"kitti_rotation_deg_per_m":0.125})");
}

}  // namespace
}  // namespace saw_ndt
