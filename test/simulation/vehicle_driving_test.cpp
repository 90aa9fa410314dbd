#include "simulation/vehicle_driving.h"

#include <gtest/gtest.h>

#include <cmath>

#include "expect_throws.h"
#include "saw_ndt/common/geometry.h"
#include "simulation/short_drive.h"

namespace saw_ndt {
namespace {

TEST(VehicleDriving, StandsOnTheGroundAndKeepsToItsLane) {
  for (const int drive : {1, 2, 3}) {
    DriveOptions options;
    options.drive = drive;
    const SimulatedDrive around = shortDrive("rural", options, 0);
    ASSERT_GT(around.motion->scanCount(), 100);
    for (const Eigen::Isometry3d& T : around.motion->T_scene_lidar) {
      const Eigen::Vector3d foot = T * Eigen::Vector3d(0.0, 0.0, -kLidarHeight_m);
      // Four wheels on uneven ground, whose mean is not the ground below the middle.
      EXPECT_NEAR(foot.z(), around.terrain->height(foot.head<2>()), 0.03);
      EXPECT_LT(around.terrain->edgeDistance(foot.head<2>()), -1.0);
    }
  }
}

TEST(VehicleDriving, SlowsDownInBendsAndNeverJumps) {
  const SimulatedDrive around = shortDrive("residential", {}, 0);
  double slowest = 1e9, fastest = 0.0;
  for (int i = 1; i < around.motion->scanCount(); ++i) {
    const Eigen::Isometry3d &before = around.motion->T_scene_lidar[static_cast<std::size_t>(i - 1)],
                            &now = around.motion->T_scene_lidar[static_cast<std::size_t>(i)];
    const double speed = (now.translation() - before.translation()).norm() / 0.1;
    slowest = std::min(slowest, speed);
    fastest = std::max(fastest, speed);
    EXPECT_LT(rotationAngle(before.linear().transpose() * now.linear()) / 0.1, 1.0);
  }
  // 2 m/s^2 in a bend of 14 m for 90 degrees, radius 8.9 m: 4.2 m/s; the course's own 8 m/s on straights.
  EXPECT_NEAR(slowest, 4.2, 0.3);
  EXPECT_NEAR(fastest, 8.0, 0.3);
}

TEST(VehicleDriving, DrivesDiffer) {
  DriveOptions second;
  second.drive = 2;
  const SimulatedDrive one = shortDrive("residential"), again = shortDrive("residential"),
                       other = shortDrive("residential", second);
  const Eigen::Isometry3d &a = one.motion->T_scene_lidar[10], &b = again.motion->T_scene_lidar[10],
                          &c = other.motion->T_scene_lidar[10];
  EXPECT_TRUE(a.isApprox(b, 0.0));
  EXPECT_GT(std::abs(a.translation().y() - c.translation().y()), 0.1);
  EXPECT_LT(std::abs(a.translation().y() - c.translation().y()), 1.0);
}

TEST(VehicleDriving, RepeatsATrajectory) {
  std::vector<Eigen::Isometry3d> poses;
  std::vector<double> stamps_s;
  std::vector<Eigen::Vector3d> positions;
  for (int i = 0; i < 80; ++i) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() << 0.8 * i, 0.004 * i * i, 0.02 * i + 1.73;
    T.linear() = Eigen::AngleAxisd(std::atan2(0.008 * i, 0.8), Eigen::Vector3d::UnitZ()).matrix();
    poses.push_back(T);
    stamps_s.push_back(0.1 * i);
    positions.emplace_back(T.translation() - Eigen::Vector3d(0.0, 0.0, kLidarHeight_m));
  }
  const Route route = Route::throughPositions(positions);
  const SceneDescription scene;
  const Terrain terrain(route, scene, 1);
  const VehicleMotion motion = followTrajectory(poses, stamps_s, terrain, {});
  ASSERT_EQ(motion.scanCount(), 80);
  for (std::size_t i = 5; i < 75; ++i) {
    const Eigen::Isometry3d difference = poses[i].inverse() * motion.T_scene_lidar[i];
    // The first drive wanders within the lane; the road's height is a mean over metres of the trajectory's.
    EXPECT_LT(std::abs(difference.translation().x()), 0.08);  // it leans by 2 degrees, 1.73 m up
    EXPECT_LT(std::abs(difference.translation().y()), 0.15);
    EXPECT_LT(std::abs(difference.translation().z()), 0.05);
    EXPECT_LT(rotationAngle(difference.linear()), radiansFromDegrees(2.5));
  }
  expectThrows<std::invalid_argument>([&] { followTrajectory(poses, {0.0}, terrain, {}); }, {"stamps"});
  stamps_s[7] = stamps_s[6];
  expectThrows<std::invalid_argument>([&] { followTrajectory(poses, stamps_s, terrain, {}); }, {"stamp"});
}

}  // namespace
}  // namespace saw_ndt
