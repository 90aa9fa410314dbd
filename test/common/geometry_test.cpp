#include "saw_ndt/common/geometry.h"

#include <gtest/gtest.h>

#include <random>

namespace saw_ndt {
namespace {

TEST(Geometry, WrapsAngles) {
  EXPECT_NEAR(wrappedAngle(3.0 * kPi), kPi, 1e-12);
  EXPECT_NEAR(wrappedAngle(-kPi), kPi, 1e-12);
  EXPECT_NEAR(wrappedAngle(radiansFromDegrees(359.0)), radiansFromDegrees(-1.0), 1e-12);
}

TEST(Geometry, XyzRpyRoundTrips) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  for (int i = 0; i < 100; ++i) {
    Vector6d xyz_rpy;
    for (double& value : xyz_rpy) value = uniform(random);
    EXPECT_LT((xyzRpyFromTransform(transformFromXyzRpy(xyz_rpy)) - xyz_rpy).norm(), 1e-12);
  }
}

TEST(Geometry, RotationVectorIsTheInverseOfItsRotation) {
  for (const double angle : {0.0, 1e-9, 1e-3, 1.0, 3.1}) {
    const Eigen::Vector3d rotation_vector = angle * Eigen::Vector3d(0.6, 0.0, -0.8);
    EXPECT_LT((rotationVector(rotationFromVector(rotation_vector)) - rotation_vector).norm(), 1e-12);
  }
}

TEST(Geometry, MeanRotationIsTheMeanOfTheRotationsOnTheWay) {
  for (const double angle : {1e-6, 0.5, 2.0}) {
    const Eigen::Vector3d rotation_vector = angle * Eigen::Vector3d(0.6, 0.0, -0.8);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 1000; ++i) sum += rotationFromVector((i + 0.5) / 1000.0 * rotation_vector);
    EXPECT_LT((meanRotation(rotation_vector) - sum / 1000.0).norm(), 1e-6);  // of the midpoint rule: angle^2 / 24e6
  }
}

TEST(Geometry, RotationAngleIsExactForSmallAngles) {
  for (const double angle : {1e-9, 1e-6, 1e-3, 1.0, 3.0}) {
    const Eigen::Vector3d rotation_vector = angle * Eigen::Vector3d(0.6, 0.0, 0.8);
    EXPECT_NEAR(rotationAngle(rotationFromVector(rotation_vector)), angle, 1e-15 + 1e-12 * angle);
  }
}

TEST(Geometry, NormalizedRotationIsARotationNearTheInput) {
  Eigen::Isometry3d T = transformFromXyzRpy((Vector6d() << 1, 2, 3, 0.1, -0.2, 2.0).finished());
  const Eigen::Isometry3d exact = T;
  T.linear() += 1e-6 * Eigen::Matrix3d::Ones();
  const Eigen::Matrix3d R = normalizedRotation(T).linear();
  EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_GT(R.determinant(), 0.0);
  EXPECT_LT((R - exact.linear()).norm(), 1e-5);
}

TEST(Geometry, HeadingIsYaw) {
  EXPECT_NEAR(heading(transformFromXyzRpy((Vector6d() << 0, 0, 0, 0.1, 0.2, -2.5).finished())), -2.5, 1e-12);
}

}  // namespace
}  // namespace saw_ndt
