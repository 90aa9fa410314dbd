#include "common/pose_interpolation.h"

#include <gtest/gtest.h>

namespace saw_ndt::internal {
namespace {

StampedPose poseOf(double stamp_s, double x_m, double yaw_deg) {
  Vector6d xyz_rpy = Vector6d::Zero();
  xyz_rpy[0] = x_m;
  xyz_rpy[5] = radiansFromDegrees(yaw_deg);
  return {stamp_s, transformFromXyzRpy(xyz_rpy)};
}

const std::vector<StampedPose> kTrajectory = {poseOf(10.0, 0.0, 170.0), poseOf(10.5, 5.0, -170.0),
                                              poseOf(12.0, 6.0, -170.0)};

TEST(PoseInterpolation, PoseOfTheSameStampIsReturnedAsItIs) {
  for (const StampedPose& pose : kTrajectory) {
    EXPECT_EQ(poseAt(kTrajectory, pose.stamp_s, 1.0)->matrix(), pose.T_map_body.matrix());
  }
}

TEST(PoseInterpolation, BetweenTwoPosesTheShortestTurnIsTaken) {
  const std::optional<Eigen::Isometry3d> pose = poseAt(kTrajectory, 10.125, 1.0);
  ASSERT_TRUE(pose.has_value());
  EXPECT_NEAR(pose->translation().x(), 1.25, 1e-12);
  EXPECT_NEAR(degreesFromRadians(heading(*pose)), 175.0, 1e-9);
}

TEST(PoseInterpolation, NothingOutsideAndInLongGaps) {
  for (const double stamp_s : {9.99, 12.01, 11.0}) {
    EXPECT_FALSE(poseAt(kTrajectory, stamp_s, 1.0).has_value()) << stamp_s;
  }
  EXPECT_TRUE(poseAt(kTrajectory, 11.0, 1.5).has_value());
  EXPECT_FALSE(poseAt({}, 11.0, 1.5).has_value());
}

TEST(PoseInterpolation, RoundedStampsOfTheEndsGetTheirPoses) {
  EXPECT_EQ(poseAt(kTrajectory, 9.9995, 1.0)->matrix(), kTrajectory.front().T_map_body.matrix());
  EXPECT_EQ(poseAt(kTrajectory, 12.0005, 1.0)->matrix(), kTrajectory.back().T_map_body.matrix());
}

}  // namespace
}  // namespace saw_ndt::internal
