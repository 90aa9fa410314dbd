#include "simulation/vehicle_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "expect_throws.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {
namespace {

// On a circle of 20 m at 10 m/s, heading along it.
Eigen::Isometry3d onCircle(double stamp_s) {
  const double angle = 0.5 * stamp_s;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << 20.0 * std::sin(angle), 20.0 * (1.0 - std::cos(angle)), 1.7;
  T.linear() = rotationFromVector({0.0, 0.0, angle});
  return T;
}

VehicleMotion circleDrive() {
  VehicleMotion motion;
  for (const double stamp_s : {5.0, 5.1, 5.25, 5.3}) {
    motion.stamps_s.push_back(stamp_s);
    motion.T_scene_lidar.push_back(onCircle(stamp_s));
  }
  return motion;
}

TEST(VehicleMotion, FollowsAnArcBetweenAndBeyondTheStamps) {
  const VehicleMotion motion = circleDrive();
  for (double stamp_s = 4.9; stamp_s <= 5.35; stamp_s += 0.01) {
    EXPECT_LT((motion.poseAt(stamp_s).matrix() - onCircle(stamp_s).matrix()).norm(), 1e-9) << stamp_s;
  }
}

TEST(VehicleMotion, RefusesTimesOutsideOfIt) {
  const VehicleMotion motion = circleDrive();
  expectThrows<std::invalid_argument>([&] { motion.poseAt(4.89); }, {"stamp_s = 4.89"});
  expectThrows<std::invalid_argument>([&] { motion.poseAt(5.36); }, {"stamp_s = 5.36"});
  expectThrows<std::invalid_argument>([&] { motion.poseAt(std::nan("")); }, {"stamp_s"});
  VehicleMotion one;
  one.stamps_s = {0.0};
  one.T_scene_lidar = {Eigen::Isometry3d::Identity()};
  expectThrows<std::invalid_argument>([&] { one.poseAt(0.0); }, {"two scans"});
  VehicleMotion standing = motion;
  standing.stamps_s.assign(4, 5.0);
  expectThrows<std::invalid_argument>([&] { standing.poseAt(5.0); }, {"do not increase"});
}

}  // namespace
}  // namespace saw_ndt
