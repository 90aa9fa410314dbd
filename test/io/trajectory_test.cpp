#include "saw_ndt/io/trajectory.h"

#include <gtest/gtest.h>

#include <random>

#include "expect_throws.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

std::vector<StampedPose> randomTrajectory() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-3.0, 3.0);
  std::vector<StampedPose> trajectory;
  for (int i = 0; i < 50; ++i) {
    Vector6d xyz_rpy;
    for (double& value : xyz_rpy) value = uniform(random);
    xyz_rpy.head<3>() *= 1e5;
    trajectory.push_back({1.3e9 + 0.103612345 * i, transformFromXyzRpy(xyz_rpy)});
  }
  return trajectory;
}

constexpr char kTumLine[] = "1.5 1 2 3 0 0 0.6 0.8\n";
constexpr char kKittiLine[] = "0 -1 0 1 1 0 0 2 0 0 1 3\n";

TEST(Trajectory, TumRoundTrips) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "t.txt";
  const std::vector<StampedPose> written = randomTrajectory();
  writeTumTrajectory(path, written);
  const Trajectory read = readTrajectory(path);
  EXPECT_EQ(read.format, TrajectoryFormat::TUM);
  ASSERT_EQ(read.poses.size(), written.size());
  for (std::size_t i = 0; i < written.size(); ++i) {
    EXPECT_NEAR(read.poses[i].stamp_s, written[i].stamp_s, 1e-6);
    EXPECT_LT((read.poses[i].T_map_body.translation() - written[i].T_map_body.translation()).norm(), 1e-9);
    EXPECT_LT((read.poses[i].T_map_body.linear() - written[i].T_map_body.linear()).norm(), 1e-10);
  }
}

TEST(Trajectory, KittiRoundTrips) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "t.txt";
  std::vector<Eigen::Isometry3d> written;
  for (const StampedPose& pose : randomTrajectory()) written.push_back(pose.T_map_body);
  writeKittiTrajectory(path, written);
  const Trajectory read = readTrajectory(path);
  EXPECT_EQ(read.format, TrajectoryFormat::KITTI);
  ASSERT_EQ(read.poses.size(), written.size());
  for (std::size_t i = 0; i < written.size(); ++i) {
    EXPECT_NEAR(read.poses[i].stamp_s, kNominalScanPeriod_s * static_cast<double>(i), 1e-12);
    EXPECT_LT((read.poses[i].T_map_body.matrix() - written[i].matrix()).norm(), 1e-6);
    EXPECT_LT((read.poses[i].T_map_body.linear() - written[i].linear()).norm(), 1e-11);
  }
}

TEST(Trajectory, ReadsTumAsStated) {
  const TemporaryFolder folder;
  const auto path = folder.write("t.txt", std::string("# stamp tx ty tz qx qy qz qw\r\n\r\n  ") + kTumLine);
  const std::vector<StampedPose> poses = readTumTrajectory(path);
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_EQ(poses[0].stamp_s, 1.5);
  EXPECT_EQ(poses[0].T_map_body.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(heading(poses[0].T_map_body), 2.0 * std::atan2(0.6, 0.8), 1e-12);
}

TEST(Trajectory, ReadsKittiAsStated) {
  const TemporaryFolder folder;
  const std::vector<Eigen::Isometry3d> poses = readKittiTrajectory(folder.write("t.txt", kKittiLine));
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_EQ(poses[0].translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(heading(poses[0]), kPi / 2.0, 1e-12);
}

TEST(Trajectory, NamesFileLineAndReason) {
  const struct {
    std::string content;
    std::string place;
    std::string reason;
  } cases[] = {
      {"", "t.txt", "holds no pose"},
      {"# only this\n", "t.txt", "holds no pose"},
      {"1 2 3\n", "line 1", "3 numbers, where 8 (TUM) or 12 (KITTI)"},
      {std::string(kTumLine) + "\n1 2 3\n", "line 3", "3 numbers, where 8 are needed"},
      {std::string(kKittiLine) + kTumLine, "line 2", "8 numbers, where 12 are needed"},
      {"1.5 1 2 3 0 0 0.6 0.9\n", "line 1", "quaternion's norm is 1.08"},
      {"1.5 1 2 3 0 0 0 0\n", "line 1", "quaternion's norm is 0.0"},
      {"1.5 1 x2 3 0 0 0.6 0.8\n", "line 1", "'x2' is no finite number"},
      {"1.5 1 2 nan 0 0 0.6 0.8\n", "line 1", "'nan' is no finite number"},
      {"2 0 0 0 0 1 0 0 0 0 1 0\n", "line 1", "no rigid transform"},
      {"-1 0 0 0 0 1 0 0 0 0 1 0\n", "line 1", "no rigid transform"},
  };
  const TemporaryFolder folder;
  for (const auto& c : cases) {
    const auto path = folder.write("t.txt", c.content);
    expectThrows<Error>([&] { readTrajectory(path); }, {path.string(), c.place, c.reason});
  }
  expectThrows<Error>([&] { readTrajectory(folder.path()); }, {folder.path().string(), "Is a directory"});
  expectThrows<Error>([&] { readTrajectory(folder.path() / "none"); }, {"none", "No such file or directory"});
  expectThrows<Error>([&] { readStamps(folder.write("times.txt", "0\n1 2\n")); }, {"times.txt", "line 2"});
}

TEST(Trajectory, CameraAndLidarPosesAreInverse) {
  const Eigen::Isometry3d Tr = transformFromXyzRpy((Vector6d() << 0, -0.1, -0.3, -1.57, 0.01, -1.56).finished());
  for (const StampedPose& pose : randomTrajectory()) {
    const Eigen::Isometry3d P = cameraPose(pose.T_map_body, Tr);
    EXPECT_LT(((P * Tr).matrix() - (Tr * pose.T_map_body).matrix()).norm(), 1e-9);
    EXPECT_LT((lidarPose(P, Tr).matrix() - pose.T_map_body.matrix()).norm(), 1e-9);
  }
}

TEST(Stamps, AreReadAsTheyWereWritten) {
  const TemporaryFolder folder;
  const std::vector<double> stamps_s = {0.0, 0.1, 1234.567891234};
  writeStamps(folder.path() / "times.txt", stamps_s);
  const std::vector<double> read_s = readStamps(folder.path() / "times.txt");
  ASSERT_EQ(read_s.size(), stamps_s.size());
  for (std::size_t i = 0; i < read_s.size(); ++i) EXPECT_NEAR(read_s[i], stamps_s[i], 1e-9);
}

}  // namespace
}  // namespace saw_ndt
