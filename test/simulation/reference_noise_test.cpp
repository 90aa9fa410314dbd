#include "simulation/reference_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "expect_throws.h"
#include "saw_ndt/common/geometry.h"
#include "simple_scene.h"

namespace saw_ndt {
namespace {

bool equal(const std::vector<Eigen::Isometry3d>& a, const std::vector<Eigen::Isometry3d>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].affine() != b[i].affine()) return false;
  }
  return a.size() == b.size();
}

TEST(ReferenceNoise, IsAStationaryGaussMarkovProcess) {
  constexpr int kSeeds = 4000;
  VehicleMotion motion = straightDrive(4, 10.0);
  motion.stamps_s = {0.0, 0.1, 15.0, 60.0};
  ReferenceNoiseOptions options;
  options.position_sigma_m = 0.05;
  Eigen::Matrix<double, 6, 4> squares = Eigen::Matrix<double, 6, 4>::Zero(), products = squares, sums = squares;
  for (int seed = 0; seed < kSeeds; ++seed) {
    options.seed = static_cast<std::uint64_t>(seed);
    const std::vector<Eigen::Isometry3d> poses = withReferenceNoise(motion, options);
    Vector6d first = Vector6d::Zero();
    for (int i = 0; i < 4; ++i) {
      Vector6d error;
      error << poses[i].translation() - motion.T_scene_lidar[i].translation(),
          rotationVector(motion.T_scene_lidar[i].linear().transpose() * poses[i].linear());
      if (i == 0) first = error;
      sums.col(i) += error;
      squares.col(i) += error.cwiseAbs2();
      products.col(i) += error.cwiseProduct(first);
    }
  }
  const double angle_sigma = radiansFromDegrees(0.3 * 0.05);
  const Vector6d sigma = (Vector6d() << 0.05, 0.05, 0.075, Eigen::Vector3d::Constant(angle_sigma)).finished();
  for (int i = 0; i < 4; ++i) {
    for (int axis = 0; axis < 6; ++axis) {
      // Bounds of five standard errors: of a mean 1 / sqrt(n), of a variance sqrt(2 / n), of a correlation at most the
      // latter.
      EXPECT_NEAR(sums(axis, i) / kSeeds / sigma[axis], 0.0, 5.0 / std::sqrt(kSeeds));
      const double variance = squares(axis, i) / kSeeds / (sigma[axis] * sigma[axis]);
      EXPECT_NEAR(variance, 1.0, 5.0 * std::sqrt(2.0 / kSeeds));
      const double correlation = products(axis, i) / kSeeds / (sigma[axis] * sigma[axis]);
      EXPECT_NEAR(correlation, std::exp(-motion.stamps_s[i] / 30.0), 5.0 * std::sqrt(2.0 / kSeeds));
    }
  }
}

TEST(ReferenceNoise, DependsOnTheSeedAlone) {
  const VehicleMotion motion = straightDrive(20, 10.0);
  ReferenceNoiseOptions options;
  const std::vector<Eigen::Isometry3d> poses = withReferenceNoise(motion, options);
  EXPECT_TRUE(equal(poses, withReferenceNoise(motion, options)));
  options.seed = 2;
  EXPECT_FALSE(equal(poses, withReferenceNoise(motion, options)));
  options.position_sigma_m = 0.0;
  EXPECT_TRUE(equal(motion.T_scene_lidar, withReferenceNoise(motion, options)));
}

TEST(ReferenceNoise, ErrorsNameTheField) {
  const VehicleMotion motion = straightDrive(2, 10.0);
  const auto expectNamed = [&](double ReferenceNoiseOptions::*field, double value, const char* name) {
    ReferenceNoiseOptions options;
    options.*field = value;
    expectThrows<std::invalid_argument>([&] { withReferenceNoise(motion, options); }, {std::string(name) + " = "});
  };
  expectNamed(&ReferenceNoiseOptions::position_sigma_m, -1.0, "position_sigma_m");
  expectNamed(&ReferenceNoiseOptions::height_sigma_ratio, std::nan(""), "height_sigma_ratio");
  expectNamed(&ReferenceNoiseOptions::rotation_sigma_deg_per_m, -1.0, "rotation_sigma_deg_per_m");
  expectNamed(&ReferenceNoiseOptions::correlation_time_s, 0.0, "correlation_time_s");
  VehicleMotion falling = motion;
  std::swap(falling.stamps_s[0], falling.stamps_s[1]);
  expectThrows<std::invalid_argument>([&] { withReferenceNoise(falling, {}); }, {"stamps_s"});
}

}  // namespace
}  // namespace saw_ndt
