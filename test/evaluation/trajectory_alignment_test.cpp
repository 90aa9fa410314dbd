#include "saw_ndt/evaluation/trajectory_alignment.h"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

#include "expect_throws.h"

namespace saw_ndt {
namespace {

Eigen::Isometry3d pose(double x, double y, double z, double roll, double pitch, double yaw) {
  return transformFromXyzRpy((Vector6d() << x, y, z, roll, pitch, yaw).finished());
}

/// Pairs of a winding drive, whose estimate is T^-1 before the reference and is moved by noise of `sigma_m`.
std::vector<PosePair> windingDrive(const Eigen::Isometry3d& T_reference_estimate, double sigma_m) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<PosePair> pairs;
  for (int i = 0; i < 60; ++i) {
    const double t = 0.1 * i;
    PosePair pair;
    pair.stamp_s = t;
    pair.T_map_reference = pose(30 * std::sin(t), 20 * t, 2 * std::cos(3 * t), 0.1 * std::sin(t), 0.05, 0.7 * t);
    pair.T_map_estimate = T_reference_estimate.inverse() * pair.T_map_reference;
    for (double& value : pair.T_map_estimate.translation()) value += sigma_m * noise(random);
    pairs.push_back(pair);
  }
  return pairs;
}

double squaredErrors(const std::vector<PosePair>& pairs, const Eigen::Isometry3d& T) {
  double sum_m2 = 0.0;
  for (const PosePair& pair : pairs) {
    sum_m2 += (pair.T_map_reference.translation() - T * pair.T_map_estimate.translation()).squaredNorm();
  }
  return sum_m2;
}

TEST(TrajectoryAlignment, AKnownTransformIsFound) {
  const Eigen::Isometry3d any = pose(5, -70, 12, 0.4, -0.8, 2.9), level = pose(5, -70, 12, 0, 0, 2.9);
  const struct {
    TrajectoryAlignment alignment;
    Eigen::Isometry3d T;
  } cases[] = {{TrajectoryAlignment::SE3, any},      {TrajectoryAlignment::SE3, level},
               {TrajectoryAlignment::YAW, level},    {TrajectoryAlignment::ORIGIN, any},
               {TrajectoryAlignment::ORIGIN, level}, {TrajectoryAlignment::NONE, Eigen::Isometry3d::Identity()}};
  for (const auto& c : cases) {
    SCOPED_TRACE(toString(c.alignment));
    const std::vector<PosePair> pairs = windingDrive(c.T, 0.0);
    EXPECT_LT((alignmentTransform(pairs, c.alignment).matrix() - c.T.matrix()).norm(), 1e-9);
    for (const PosePair& pair : alignedPairs(pairs, c.alignment)) {
      EXPECT_LT((pair.T_map_estimate.matrix() - pair.T_map_reference.matrix()).norm(), 1e-9);
    }
  }
}

// A quarter turn to the left and (5, 6, 7), by hand.
TEST(TrajectoryAlignment, AQuarterTurnIsFound) {
  const double reference[][3] = {{5, 6, 7}, {5, 7, 7}, {5, 8, 7}, {4, 8, 7}};
  const double estimate[][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}};
  std::vector<PosePair> pairs(4);
  for (std::size_t i = 0; i < 4; ++i) {
    pairs[i].T_map_reference.translation() = Eigen::Map<const Eigen::Vector3d>(reference[i]);
    pairs[i].T_map_estimate.translation() = Eigen::Map<const Eigen::Vector3d>(estimate[i]);
  }
  for (const TrajectoryAlignment alignment : {TrajectoryAlignment::SE3, TrajectoryAlignment::YAW}) {
    EXPECT_LT((alignmentTransform(pairs, alignment).matrix() - pose(5, 6, 7, 0, 0, kPi / 2).matrix()).norm(), 1e-12);
  }
}

TEST(TrajectoryAlignment, NoOtherTransformIsNearer) {
  const std::vector<PosePair> pairs = windingDrive(pose(5, -70, 12, 0.1, -0.1, 2.9), 0.5);
  const Eigen::Isometry3d rigid = alignmentTransform(pairs, TrajectoryAlignment::SE3);
  const Eigen::Isometry3d yaw = alignmentTransform(pairs, TrajectoryAlignment::YAW);
  EXPECT_EQ(yaw.linear().col(2), Eigen::Vector3d::UnitZ());
  EXPECT_LT(squaredErrors(pairs, rigid), squaredErrors(pairs, yaw));
  for (int axis = 0; axis < 6; ++axis) {
    for (const double step : {-1e-4, 1e-4}) {
      Vector6d change = Vector6d::Zero();
      change(axis) = step;
      const Eigen::Isometry3d other = transformFromXyzRpy(change);
      EXPECT_GT(squaredErrors(pairs, rigid * other), squaredErrors(pairs, rigid));
      if (axis < 3 || axis == 5) {
        EXPECT_GT(squaredErrors(pairs, yaw * other), squaredErrors(pairs, yaw));
      }
    }
  }
}

TEST(TrajectoryAlignment, AMirroredEstimateIsTurnedAndNotMirrored) {
  std::vector<PosePair> pairs = windingDrive(Eigen::Isometry3d::Identity(), 0.0);
  for (PosePair& pair : pairs) pair.T_map_estimate.translation().y() *= -1.0;
  EXPECT_NEAR(alignmentTransform(pairs, TrajectoryAlignment::SE3).linear().determinant(), 1.0, 1e-12);
}

TEST(TrajectoryAlignment, WhatTellsNoRotationIsRefused) {
  std::vector<PosePair> standing(5), line(5), ascent(5);
  for (std::size_t i = 0; i < 5; ++i) {
    const double way_m = 3.0 * static_cast<double>(i);
    standing[i].T_map_reference.translation() << 400, 500, 6;
    standing[i].T_map_estimate.translation() << 100, 200, 3;
    line[i].T_map_reference.translation() << 400 + way_m, 500 + 2 * way_m, 6 - way_m;
    line[i].T_map_estimate.translation() << 100 + 2 * way_m, 200 - way_m, 3 - way_m;
    ascent[i].T_map_reference.translation().z() = ascent[i].T_map_estimate.translation().z() = way_m;
  }
  const auto expectRefused = [](const std::vector<PosePair>& pairs, TrajectoryAlignment alignment,
                                const std::string& reason) {
    expectThrows<std::invalid_argument>([&] { alignmentTransform(pairs, alignment); }, {"cannot be aligned", reason});
  };
  const std::vector<PosePair> one(standing.begin(), standing.begin() + 1);
  expectRefused(one, TrajectoryAlignment::SE3, "1 pairs are the same or on one line");
  expectRefused(standing, TrajectoryAlignment::SE3, "5 pairs are the same or on one line");
  expectRefused(line, TrajectoryAlignment::SE3, "on one line");
  expectRefused(one, TrajectoryAlignment::YAW, "the same seen from above");
  expectRefused(standing, TrajectoryAlignment::YAW, "the same seen from above");
  expectRefused(ascent, TrajectoryAlignment::YAW, "the same seen from above");
  EXPECT_NEAR(heading(alignmentTransform(line, TrajectoryAlignment::YAW)), kPi / 2, 1e-12);
  EXPECT_EQ(alignmentTransform(one, TrajectoryAlignment::ORIGIN).translation(), Eigen::Vector3d(300, 300, 3));
  expectThrows<std::invalid_argument>([] { alignmentTransform({}, TrajectoryAlignment::NONE); }, {"no pairs"});
}

}  // namespace
}  // namespace saw_ndt
