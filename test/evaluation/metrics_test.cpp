#include "saw_ndt/evaluation/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "expect_throws.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {
namespace {

StampedPose poseAt(double stamp_s, double x, double y, double yaw_deg) {
  return {stamp_s, transformFromXyzRpy((Vector6d() << x, y, 0, 0, 0, radiansFromDegrees(yaw_deg)).finished())};
}

const std::vector<StampedPose> kReference{poseAt(0.0, 0, 0, 0), poseAt(0.1, 1, 0, 10), poseAt(0.2, 2, 0, 179)};

TEST(Metrics, HandComputedErrors) {
  // Position errors 0, 3 and 5 m; yaw errors 1, 0 and 2 degrees, the last across +-180.
  const std::vector<StampedPose> estimate{poseAt(0.0, 0, 0, -1), poseAt(0.1, 1, 3, 10), poseAt(0.2, 6, 3, -179)};
  const TrajectoryMetrics metrics = evaluateTrajectory(kReference, estimate, 0.0);
  EXPECT_EQ(metrics.evaluated_scans, 3U);
  EXPECT_NEAR(metrics.ate_rmse_m, std::sqrt(34.0 / 3.0), 1e-12);
  EXPECT_NEAR(metrics.position_mean_m, 8.0 / 3.0, 1e-12);
  EXPECT_NEAR(metrics.position_median_m, 3.0, 1e-12);
  EXPECT_NEAR(metrics.position_p95_m, 4.8, 1e-12);
  EXPECT_NEAR(metrics.position_max_m, 5.0, 1e-12);
  EXPECT_NEAR(metrics.yaw_mae_deg, 1.0, 1e-9);
  EXPECT_NEAR(metrics.yaw_p95_deg, 1.9, 1e-9);
}

TEST(Metrics, NothingIsAligned) {
  std::vector<StampedPose> shifted = kReference;
  for (StampedPose& pose : shifted) pose.T_map_body.translation().z() += 0.5;
  EXPECT_NEAR(evaluateTrajectory(kReference, shifted, 0.0).ate_rmse_m, 0.5, 1e-12);
}

TEST(Metrics, MatchesTheNearestStampWithinTheTolerance) {
  const std::vector<StampedPose> estimate{poseAt(0.205, 2, 1, 179), poseAt(0.094, 1, 2, 10), poseAt(0.15, 9, 9, 9),
                                          poseAt(-0.01, 0, 3, 0), poseAt(0.3, 9, 9, 9)};
  const std::vector<PosePair> pairs = matchTrajectories(kReference, estimate, 0.0);
  ASSERT_EQ(pairs.size(), 3U);
  EXPECT_EQ(pairs[0].stamp_s, -0.01);
  EXPECT_EQ(pairs[1].stamp_s, 0.094);
  EXPECT_EQ(pairs[2].stamp_s, 0.205);
  EXPECT_EQ(pairs[1].T_map_reference.translation().x(), 1.0);
  EXPECT_EQ(pairs[1].T_map_estimate.translation().y(), 2.0);
}

// Compared with itself, a trajectory with equal stamps would be metres off.
TEST(Metrics, PosesOfTheSameStampAreNotCompared) {
  std::vector<StampedPose> equal{poseAt(0.0, 0, 0, 0), poseAt(0.1, 1, 0, 0), poseAt(0.1, 2.5, 0, 0)};
  const std::vector<StampedPose> good{poseAt(0.0, 0, 0, 0), poseAt(0.1, 1, 0, 0)};
  expectThrows<std::invalid_argument>([&] { matchTrajectories(equal, good, 0.0); },
                                      {"reference trajectory", "1.5 m apart", "same stamp 0.1 s"});
  expectThrows<std::invalid_argument>([&] { matchTrajectories(good, equal, 0.0); }, {"estimated trajectory"});
  equal[2] = equal[1];
  EXPECT_EQ(evaluateTrajectory(equal, equal, 0.0).position_max_m, 0.0);
}

TEST(Metrics, SkipsFromTheFirstEstimatedStamp) {
  const std::vector<StampedPose> estimate{poseAt(0.1, 1, 9, 0), poseAt(0.2, 2, 1, 179)};
  EXPECT_EQ(evaluateTrajectory(kReference, estimate, 0.0).evaluated_scans, 2U);
  const TrajectoryMetrics metrics = evaluateTrajectory(kReference, estimate, 0.1);
  EXPECT_EQ(metrics.evaluated_scans, 1U);
  EXPECT_NEAR(metrics.position_max_m, 1.0, 1e-12);
}

TEST(Metrics, SaysWhyNothingCanBeEvaluated) {
  const auto expectRefused = [](const std::vector<StampedPose>& reference, const std::vector<StampedPose>& estimate,
                                double skip_s, const std::string& reason) {
    expectThrows<std::invalid_argument>([&] { evaluateTrajectory(reference, estimate, skip_s); }, {reason});
  };
  expectRefused(kReference, kReference, 3.0, "all 3 estimated poses are within the first 3 s");
  expectRefused(kReference, {poseAt(5.0, 0, 0, 0)}, 0.0, "no reference stamp (0 to 0.2 s) is within 0.01 s");
  expectRefused({}, kReference, 0.0, "reference trajectory holds no pose");
  expectRefused(kReference, {}, 0.0, "estimated trajectory holds no pose");
  expectRefused(kReference, kReference, -1.0, "skip_s = -1");
  std::vector<StampedPose> broken = kReference;
  broken[1].T_map_body.translation().x() = std::numeric_limits<double>::quiet_NaN();
  expectRefused(kReference, broken, 0.0, "pose 1 of the estimated trajectory is not finite");
}

}  // namespace
}  // namespace saw_ndt
