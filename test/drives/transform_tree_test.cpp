#include "drives/transform_tree.h"

#include <gtest/gtest.h>

namespace saw_ndt::internal {
namespace {

Eigen::Isometry3d poseOf(double x_m, double y_m, double yaw_deg) {
  Vector6d xyz_rpy = Vector6d::Zero();
  xyz_rpy[0] = x_m;
  xyz_rpy[1] = y_m;
  xyz_rpy[5] = radiansFromDegrees(yaw_deg);
  return transformFromXyzRpy(xyz_rpy);
}

void expectNear(const std::optional<Eigen::Isometry3d>& T, const Eigen::Isometry3d& expected) {
  ASSERT_TRUE(T.has_value());
  EXPECT_LT((T->matrix() - expected.matrix()).cwiseAbs().maxCoeff(), 1e-12);
}

/// map -> odom drifts sideways, odom -> base turns and drives, base -> lidar and base -> camera are fixed.
class TransformTreeTest : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const int step : {3, 1, 0, 2}) {
      tree.add("odom", "base", 10.0 + 0.5 * step, odomBase(0.5 * step));
      tree.add("map", "odom", 10.1 + 0.5 * step, mapOdom(0.1 + 0.5 * step));
    }
    tree.setFixed("base", "lidar", kMounting);
    tree.setFixed("base", "camera", poseOf(0.0, 1.0, 90.0));
    tree.sort();
  }
  static Eigen::Isometry3d odomBase(double t) { return poseOf(4.0 * t, 0.0, 60.0 * t); }
  static Eigen::Isometry3d mapOdom(double t) { return poseOf(0.0, 0.3 * t, 0.0); }

  const Eigen::Isometry3d kMounting = poseOf(1.0, 0.5, 30.0);
  TransformTree tree;
};

TEST_F(TransformTreeTest, EveryLinkIsInterpolatedAtTheStamp) {
  for (const double t : {0.1, 0.2, 0.75, 1.0, 1.33}) {
    SCOPED_TRACE(t);
    expectNear(tree.find("map", "lidar", 10.0 + t), mapOdom(t) * odomBase(t) * kMounting);
    expectNear(tree.find("lidar", "map", 10.0 + t), (mapOdom(t) * odomBase(t) * kMounting).inverse());
  }
}

TEST_F(TransformTreeTest, FramesBesideEachOtherAreReachedByTheOneAbove) {
  expectNear(tree.find("camera", "lidar", 0.0), poseOf(0.0, 1.0, 90.0).inverse() * kMounting);
  expectNear(tree.find("base", "base", 0.0), Eigen::Isometry3d::Identity());
}

TEST_F(TransformTreeTest, NothingIsToldWhereALinkTellsNothing) {
  EXPECT_FALSE(tree.find("map", "lidar", 10.05).has_value());  // before the first of map -> odom
  EXPECT_TRUE(tree.find("odom", "lidar", 10.05).has_value());
  EXPECT_FALSE(tree.find("map", "lidar", 11.55).has_value());
  EXPECT_FALSE(tree.find("map", "other", 10.5).has_value());
  tree.add("map", "odom", 13.0, mapOdom(3.0));
  tree.add("odom", "base", 12.0, odomBase(2.0));
  EXPECT_FALSE(tree.find("map", "lidar", 11.8).has_value());  // a gap of 1.4 s
}

TEST_F(TransformTreeTest, RootAndConnectionsAreThoseOfTheTree) {
  EXPECT_EQ(tree.rootOf("lidar"), "map");
  EXPECT_EQ(tree.rootOf("other"), "other");
  EXPECT_TRUE(tree.connects("camera", "odom"));
  EXPECT_FALSE(tree.connects("camera", "other"));
  EXPECT_EQ(tree.frames(), (std::set<std::string>{"base", "camera", "lidar", "map", "odom"}));
}

TEST_F(TransformTreeTest, WhatIsRepeatedAtOnePlaceDoesNotMove) {
  EXPECT_TRUE(tree.moves("odom", "lidar"));
  EXPECT_FALSE(tree.moves("camera", "lidar"));
  tree.add("lidar", "cover", 10.0, kMounting);
  tree.add("lidar", "cover", 10.1, kMounting);
  EXPECT_FALSE(tree.moves("lidar", "cover"));
}

TEST_F(TransformTreeTest, RingsAndSecondParentsAreLeftOut) {
  tree.setFixed("other", "base", kMounting);
  expectNear(tree.find("odom", "base", 10.5), odomBase(0.5));
  tree.setFixed("b", "a", kMounting);
  tree.setFixed("a", "b", kMounting);
  EXPECT_TRUE(tree.connects("a", "b"));
  EXPECT_FALSE(tree.connects("a", "map"));
}

}  // namespace
}  // namespace saw_ndt::internal
