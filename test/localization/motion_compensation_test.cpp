#include "localization/motion_compensation.h"

#include <gtest/gtest.h>

#include <limits>

#include "localization/synthetic_drive.h"

namespace saw_ndt::internal {
namespace {

Eigen::Vector3d pointOf(const SourcePoints& points, std::size_t i) {
  return Eigen::Vector3f(points.x[i], points.y[i], points.z[i]).cast<double>();
}

SourcePoints pointsOf(const std::vector<Eigen::Vector3f>& positions) {
  SourcePoints points;
  for (const Eigen::Vector3f& p : positions) points.add(p.x(), p.y(), p.z(), StructuralLabel::NON_GROUND);
  return points;
}

TEST(MotionCompensation, AConstantVelocityMovesAPointByItsTime) {
  const SourcePoints measured = pointsOf({{10, 0, 0}, {-10, 1, 2}, {0, 5, -1}});
  SourcePoints moved;
  compensate(measured, {0.0F, -0.05F, 0.025F}, ScanMotion::even({{30.0, 0.0, 1.0}, Eigen::Vector3d::Zero()}), moved);
  EXPECT_LT((pointOf(moved, 0) - Eigen::Vector3d(10, 0, 0)).norm(), 1e-6);
  EXPECT_LT((pointOf(moved, 1) - Eigen::Vector3d(-11.5, 1, 1.95)).norm(), 1e-5);
  EXPECT_LT((pointOf(moved, 2) - Eigen::Vector3d(0.75, 5, -0.975)).norm(), 1e-5);
}

TEST(MotionCompensation, ATurnTurnsAPointByItsTime) {
  const SourcePoints measured = pointsOf({{10, 0, 0}, {10, 0, 0}});
  SourcePoints moved;
  compensate(measured, {0.05F, -0.05F}, ScanMotion::even({Eigen::Vector3d::Zero(), {0.0, 0.0, kPi}}), moved);
  const double angle = 0.05 * kPi;
  EXPECT_LT((pointOf(moved, 0) - 10.0 * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0)).norm(), 1e-5);
  EXPECT_LT((pointOf(moved, 1) - 10.0 * Eigen::Vector3d(std::cos(angle), -std::sin(angle), 0)).norm(), 1e-5);
}

// exp() of the twist, each side of the stamp with its own.
TEST(MotionCompensation, AScrewMovesAPointAsTheBodyMoves) {
  const ScanMotion motion{{{20.0, -1.0, 0.5}, {0.1, -0.2, 1.5}}, {{18.0, 0.0, 0.0}, {-0.3, 0.1, -0.8}}};
  const std::vector<Eigen::Vector3f> positions = {{30, 10, 2}, {-12, 40, -1.7F}, {3, -8, 5}};
  for (const float time_s : {-0.1F, -0.03F, 0.04F, 0.1F}) {
    SourcePoints moved;
    compensate(pointsOf(positions), std::vector<float>(3, time_s), motion, moved);
    const BodyMotion& body = time_s < 0.0F ? motion.before : motion.after;
    const Eigen::Vector3d turned = static_cast<double>(time_s) * body.turn_rate_radps;
    const Eigen::Vector3d way = static_cast<double>(time_s) * (meanRotation(turned) * body.velocity_mps);
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d expected = rotationFromVector(turned) * positions[i].cast<double>() + way;
      EXPECT_LT((pointOf(moved, i) - expected).norm(), 2e-5) << time_s << ' ' << i;
    }
  }
}

TEST(MotionCompensation, TheMotionBetweenPosesIsTheOneThatLeadsThere) {
  const BodyMotion motion{{12.0, 0.3, -0.2}, {0.05, 0.02, 0.9}};
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = rotationFromVector(0.2 * motion.turn_rate_radps);
  T.translation() = 0.2 * (meanRotation(0.2 * motion.turn_rate_radps) * motion.velocity_mps);
  const BodyMotion found = motionBetween(T, 0.2);
  EXPECT_LT((found.velocity_mps - motion.velocity_mps).norm(), 1e-9);
  EXPECT_LT((found.turn_rate_radps - motion.turn_rate_radps).norm(), 1e-9);
}

/// Expects that times from `first` on over a turn are read as from `first_s` from the stamp on.
void expectClock(double first, double span, double stamp_s, double first_s) {
  SCOPED_TRACE(first);
  const std::vector<LidarPoint> points(3, LidarPoint{5, 1, 0, 0});
  const std::vector<double> times = {first, first + 0.25 * span, first + span};
  ScanView view = viewOf(points);
  view.times_s = PointField(times.data());
  const std::optional<ScanClock> clock = clockOf(view, stamp_s);
  ASSERT_TRUE(clock);
  EXPECT_NEAR((*clock)(times[0]), first_s, 2e-6);
  EXPECT_NEAR((*clock)(times[1]), first_s + 0.025, 2e-6);
  EXPECT_NEAR((*clock)(times[2]), first_s + 0.1, 2e-6);
}

TEST(MotionCompensation, TimesAreReadInAnyUsualForm) {
  constexpr double kStamp_s = 1.6e9 + 12.5;
  for (const double units : {1.0, 1e3, 1e6, 1e9}) {
    SCOPED_TRACE(units);
    expectClock(0.0, 0.1 * units, kStamp_s, 0.0);                              // from the first point
    expectClock(-0.1 * units, 0.1 * units, kStamp_s, -0.1);                    // to the last
    expectClock(-0.05 * units, 0.1 * units, kStamp_s, -0.05);                  // from the stamp in the middle
    expectClock((kStamp_s - 0.05) * units, 0.1 * units, kStamp_s, -0.05);      // absolute
    expectClock((kStamp_s - 0.05 + 1e6) * units, 0.1 * units, kStamp_s, 0.0);  // by a clock of its own
    expectClock((kStamp_s - 0.05) * units, 0.1 * units, 0.5, 0.0);             // likewise, stamps from 0
  }
}

TEST(MotionCompensation, TimesThatSayNothingAreNone) {
  const std::vector<LidarPoint> points = {{5, 1, 0, 0}, {5, 2, 0, 0}, {0, 0, 0, 0}};
  ScanView view = viewOf(points);
  EXPECT_FALSE(clockOf(view, 0.0));
  for (const std::vector<double>& times :
       {std::vector<double>{3.0, 3.0, 3.05}, {0.0, 1e-6, 0.1}, {0.0, 40.0 * 86400.0, 0.1}}) {
    view.times_s = PointField(times.data());
    EXPECT_FALSE(clockOf(view, 0.0)) << times[1];
  }
}

TEST(MotionCompensation, AzimuthsTellTimesInBothDirectionsAndAnyMounting) {
  Eigen::Isometry3d T_base_lidar = Eigen::Isometry3d::Identity();
  T_base_lidar.translation() << 1.0, -0.3, 1.8;
  T_base_lidar.linear() = rotationFromVector({0.1, -0.05, 0.7});
  SourcePoints points;
  std::vector<double> turns;
  for (int i = -180; i < 180; i += 7) {
    const double azimuth = radiansFromDegrees(i);
    const Eigen::Vector3f p =
        (T_base_lidar * Eigen::Vector3d(20 * std::cos(azimuth), 20 * std::sin(azimuth), 3)).cast<float>();
    points.add(p.x(), p.y(), p.z(), StructuralLabel::NON_GROUND);
    turns.push_back(i / 360.0);
  }
  for (const bool counterclockwise : {true, false}) {
    std::vector<float> times_s;
    timesFromAzimuth(points, T_base_lidar, counterclockwise, 0.1, times_s);
    ASSERT_EQ(times_s.size(), turns.size());
    for (std::size_t i = 1; i < turns.size(); ++i) {  // the first lies on the seam
      EXPECT_NEAR(times_s[i], (counterclockwise ? 0.1 : -0.1) * turns[i], 1e-6) << turns[i];
    }
  }
}

TEST(MotionCompensation, AScanIsThatOfALidarThatStandsAtTheStamp) {
  const SensorModel sensor = SensorModel::named("VLP-16");
  const BodyMotion body{{25.0, 0.0, 0.0}, {0.0, 0.0, 0.6}};
  Eigen::Isometry3d T_ground_lidar = Eigen::Isometry3d::Identity();
  T_ground_lidar.translation() << -10.0, 0.0, 1.73;
  const auto poseAt = [&](double time_s) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = rotationFromVector(time_s * body.turn_rate_radps);
    T.translation() = time_s * (meanRotation(time_s * body.turn_rate_radps) * body.velocity_mps);
    return Eigen::Isometry3d(T_ground_lidar * T);
  };
  // What is far from a block's face lies on none: 1 cm of noise along the ray.
  const auto offSurface = [](const std::vector<LidarPoint>& scan, const Eigen::Isometry3d& T) {
    double sum = 0.0;
    std::size_t count = 0;
    for (const LidarPoint& point : scan) {
      const Eigen::Vector3d p = Eigen::Vector3f(point.x, point.y, point.z).cast<double>();
      const Eigen::Vector3d direction = T.linear() * p.normalized();
      const double error = rangeAmong(streetBlocks(), T.translation(), direction) - p.norm();
      if (std::abs(error) > 0.5) continue;  // seen past an edge
      sum += error * error;
      ++count;
    }
    EXPECT_GT(count, scan.size() * 3 / 4);
    return std::sqrt(sum / static_cast<double>(count));
  };
  for (const double period_s : {0.1, -0.1}) {
    std::vector<double> times_s;
    const std::vector<LidarPoint> raw = scanBlocksInMotion(streetBlocks(), sensor, poseAt, period_s, 1, &times_s);
    ScanView view = viewOf(raw);
    std::vector<LidarPoint> moved;
    const auto azimuth =
        period_s > 0.0 ? MotionCompensation::FROM_AZIMUTH_COUNTERCLOCKWISE : MotionCompensation::FROM_AZIMUTH_CLOCKWISE;
    EXPECT_FALSE(compensateScan(view, MotionCompensation::FROM_TIMES, {7.0, 0.1}, ScanMotion::even(body), moved));
    EXPECT_TRUE(compensateScan(view, azimuth, {7.0, 0.1}, ScanMotion::even(body), moved));
    ASSERT_EQ(moved.size(), raw.size());
    EXPECT_LT(offSurface(moved, T_ground_lidar), 0.03);
    EXPECT_GT(offSurface(raw, T_ground_lidar), 0.1);
    view.times_s = PointField(times_s.data());
    std::vector<LidarPoint> by_times;
    EXPECT_TRUE(compensateScan(view, MotionCompensation::FROM_TIMES, {7.0, 0.1}, ScanMotion::even(body), by_times));
    for (std::size_t i = 0; i < raw.size(); i += 97) {
      EXPECT_NEAR(by_times[i].x, moved[i].x, 1e-3);
      EXPECT_NEAR(by_times[i].y, moved[i].y, 1e-3);
    }
  }
}

TEST(MotionCompensation, WhatIsNoReturnOrHasNoTimeStaysAsItIs) {
  const std::vector<LidarPoint> points = {{0, 0, 0, 0}, {5, 5, 1, 0}, {-5, 5, 1, 0}, {5, -5, 1, 0}};
  const std::vector<double> times = {0.02, std::numeric_limits<double>::quiet_NaN(), 0.0, 0.1};
  ScanView view = viewOf(points);
  view.times_s = PointField(times.data());
  std::vector<LidarPoint> moved;
  ASSERT_TRUE(
      compensateScan(view, MotionCompensation::FROM_TIMES, {}, ScanMotion::even({{10, 0, 0}, {0, 0, 0}}), moved));
  for (const std::size_t i : {0U, 1U, 2U}) EXPECT_EQ(moved[i].x, points[i].x);
  EXPECT_NEAR(moved[3].x, 6.0, 1e-6);
}

TEST(ScanPeriodTest, IsTheMedianDistanceOfStamps) {
  ScanPeriod period;
  EXPECT_DOUBLE_EQ(period.seconds(), 0.1);
  for (const double stamp_s : {5.0, 5.05, 5.10, 5.20, 5.25, 5.25, 9.0, 9.05}) period.add(stamp_s);
  EXPECT_NEAR(period.seconds(), 0.05, 1e-9);
  ScanPeriod known(0.2);
  known.add(0.0);
  known.add(0.1);
  EXPECT_EQ(known.seconds(), 0.2);
}

TEST(MovingSourceTest, AVehicleThatHardlyMovesLeavesTheVeryPoints) {
  const SourcePoints measured = pointsOf({{10, 0, 0}, {-10, 1, 2}});
  const std::vector<float> times_s = {0.0F, -0.05F};
  MovingSource source;
  source.take(measured, times_s);
  EXPECT_TRUE(source.hasTimes());
  EXPECT_EQ(&source.compensatedBy(ScanMotion()), &measured);
  EXPECT_EQ(&source.compensatedBy(ScanMotion::even({{0.05, 0, 0}, {0, 0, 0.005}})), &measured);
  EXPECT_NE(&source.compensatedBy(ScanMotion::even({{5.0, 0, 0}, {0, 0, 0}})), &measured);
  const std::vector<float> none;
  source.take(measured, none);
  EXPECT_FALSE(source.hasTimes());
  EXPECT_EQ(&source.compensatedBy(ScanMotion::even({{5.0, 0, 0}, {0, 0, 0}})), &measured);
}

}  // namespace
}  // namespace saw_ndt::internal
