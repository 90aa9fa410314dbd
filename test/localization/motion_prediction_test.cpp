#include "saw_ndt/localization/motion_prediction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "expect_throws.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {
namespace {

Eigen::Isometry3d poseAt(double x, double y, double yaw) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << x, y, 0.5;
  T.linear() = rotationFromVector({0.0, 0.0, yaw});
  return T;
}

/// 10 m/s on a circle of 20 m radius: 0.5 rad/s.
Eigen::Isometry3d onCircle(double stamp_s) {
  const double yaw = 0.5 * stamp_s;
  return poseAt(20.0 * std::sin(yaw), 20.0 * (1.0 - std::cos(yaw)), yaw);
}

void expectSamePose(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, double tolerance) {
  EXPECT_LT((a.translation() - b.translation()).norm(), tolerance);
  EXPECT_LT(rotationAngle(a.linear().transpose() * b.linear()), tolerance);
}

TEST(MotionPrediction, FollowsACircleWhateverTheStamps) {
  MotionPrediction prediction;
  prediction.reset(onCircle(0.0));
  double last_s = 0.0;
  prediction.accept(onCircle(last_s), last_s);
  for (const double step_s : {0.1, 0.1, 0.05, 0.3, 1e-6, 2.0, 0.1}) {
    prediction.accept(onCircle(last_s + step_s), last_s + step_s);
    last_s += step_s;
    ASSERT_TRUE(prediction.state().velocity_known);
    const double tolerance = step_s < 1e-3 ? 1e-6 : 1e-9;  // positions of 1e-15 m over a microsecond
    for (const double ahead_s : {0.0, 0.05, 0.1, 0.7}) {
      expectSamePose(prediction.predict(last_s + ahead_s), onCircle(last_s + ahead_s), tolerance);
    }
  }
}

TEST(MotionPrediction, GoesStraightAndStands) {
  MotionPrediction prediction;
  prediction.accept(poseAt(1.0, 2.0, 0.7), 10.0);
  prediction.accept(poseAt(1.0 + std::cos(0.7), 2.0 + std::sin(0.7), 0.7), 10.1);
  expectSamePose(prediction.predict(10.25), poseAt(1.0 + 2.5 * std::cos(0.7), 2.0 + 2.5 * std::sin(0.7), 0.7), 1e-9);
  prediction.accept(poseAt(1.0 + std::cos(0.7), 2.0 + std::sin(0.7), 0.7), 10.2);
  expectSamePose(prediction.predict(11.0), poseAt(1.0 + std::cos(0.7), 2.0 + std::sin(0.7), 0.7), 1e-12);
}

TEST(MotionPrediction, FollowsAScrewInThreeDimensions) {
  Eigen::Isometry3d step = Eigen::Isometry3d::Identity();
  step.translation() << 0.5, -0.2, 0.1;
  step.linear() = rotationFromVector({0.03, -0.05, 0.08});
  MotionPrediction prediction;
  const Eigen::Isometry3d start = poseAt(-3.0, 4.0, 2.0);
  prediction.accept(start, 0.0);
  prediction.accept(start * step, 0.1);
  expectSamePose(prediction.predict(0.2), start * step * step, 1e-12);
  expectSamePose(prediction.predict(0.4), start * step * step * step * step, 1e-12);
}

TEST(MotionPrediction, BoundsSpeedAndTurnRate) {
  MotionPredictionOptions options;
  options.max_speed_mps = 20.0;
  options.max_turn_rate_radps = 0.5;
  MotionPrediction prediction(options);
  prediction.accept(poseAt(0.0, 0.0, 0.0), 0.0);
  prediction.accept(poseAt(5.0, 0.0, 0.0), 0.1);  // 50 m/s
  expectSamePose(prediction.predict(0.2), poseAt(7.0, 0.0, 0.0), 1e-12);
  prediction.accept(poseAt(5.0, 0.0, 0.3), 0.2);  // 3 rad/s
  expectSamePose(prediction.predict(0.4), poseAt(5.0, 0.0, 0.4), 1e-12);
}

TEST(MotionPrediction, IsTheLastPoseBeforeThereAreTwo) {
  MotionPrediction prediction;
  prediction.reset(poseAt(1.0, 1.0, 1.0));
  EXPECT_FALSE(prediction.state().timeSinceLast(5.0).has_value());
  expectSamePose(prediction.predict(5.0), poseAt(1.0, 1.0, 1.0), 1e-15);
  prediction.accept(poseAt(2.0, 2.0, 1.0), 5.0);
  EXPECT_FALSE(prediction.state().velocity_known);
  EXPECT_DOUBLE_EQ(prediction.state().timeSinceLast(5.5).value(), 0.5);
  expectSamePose(prediction.predict(6.0), poseAt(2.0, 2.0, 1.0), 1e-15);
}

/// 10 m/s along x, the last pose at (1, 0) and 1 s.
MotionPrediction underWay() {
  MotionPrediction prediction;
  prediction.accept(poseAt(0.0, 0.0, 0.0), 0.9);
  prediction.accept(poseAt(1.0, 0.0, 0.0), 1.0);
  EXPECT_TRUE(prediction.state().velocity_known);
  return prediction;
}

TEST(MotionPrediction, ALateScanIsWhereTheVehicleWasAndAddsNothing) {
  for (const double late_s : {0.0, 0.1, 0.9}) {
    MotionPrediction prediction = underWay();
    const Eigen::Isometry3d was_at = poseAt(1.0 - 10.0 * late_s, 0.0, 0.0);
    expectSamePose(prediction.predict(1.0 - late_s), was_at, 1e-12);
    const MeasuredPose pose{was_at};
    EXPECT_FALSE(prediction.isSurprising(pose, 1.0 - late_s));
    prediction.accept(pose, 1.0 - late_s);
    expectSamePose(prediction.predict(1.1), poseAt(2.0, 0.0, 0.0), 1e-12);
  }
}

TEST(MotionPrediction, AClockThatIsSetBackIsFollowed) {
  // By more than a second: at once. The velocity is kept.
  MotionPrediction prediction = underWay();
  expectSamePose(prediction.predict(-5.0), poseAt(1.0, 0.0, 0.0), 1e-15);
  EXPECT_GT(3.0 * std::sqrt(prediction.predictedCovariance(-5.0)(0, 0)), 10.0);  // of the way of a second
  prediction.accept(poseAt(2.0, 0.0, 0.0), -5.0);
  expectSamePose(prediction.predict(-4.9), poseAt(3.0, 0.0, 0.0), 1e-12);

  // By less: where the vehicle could not have been at that time.
  prediction = underWay();
  MeasuredPose pose{poseAt(2.0, 0.0, 0.0)};
  EXPECT_TRUE(prediction.isSurprising(pose, 0.2));
  pose.learn_velocity = false;
  prediction.accept(pose, 0.2);
  expectSamePose(prediction.predict(0.3), poseAt(3.0, 0.0, 0.0), 1e-12);

  // Or where scans do not tell how far it came, at the third in a row. The covariance holds where it may be.
  prediction = underWay();
  const PoseDirections along_x = Vector6d::Unit(0);
  for (const double stamp_s : {0.2, 0.3, 0.4}) {
    prediction.accept({prediction.predict(stamp_s), Matrix6d::Zero(), along_x}, stamp_s);
  }
  EXPECT_EQ(prediction.state().stamp_s, 0.4);
  const double true_x_m = 4.0, x_m = prediction.state().T_map_base.translation().x();
  EXPECT_NEAR(x_m, -5.0, 1e-9);
  EXPECT_GT(3.0 * std::sqrt(prediction.state().covariance(0, 0)), true_x_m - x_m);
}

TEST(MotionPrediction, AGapIsDoubted) {
  // A second without scans, or a stamp that is a second too late: both are held by the covariance.
  MotionPrediction prediction = underWay();
  expectSamePose(prediction.predict(2.1), poseAt(12.0, 0.0, 0.0), 1e-12);
  EXPECT_GT(3.0 * std::sqrt(prediction.predictedCovariance(2.1)(0, 0)), 10.0);
  // Across, an acceleration of 3 m/s^2 moves it 0.15 m/s 1.1 s + 3 m/s^2 (1.1 s)^2 / 2, and by 3.45 m/s in half of the
  // time more.
  EXPECT_NEAR(std::sqrt(prediction.predictedCovariance(2.1)(1, 1)), std::hypot(1.98, 0.55 * 3.45), 0.01);
  MeasuredPose pose{poseAt(2.0, 0.0, 0.0)};
  EXPECT_TRUE(prediction.isSurprising(pose, 2.1)) << "the stamp, or the vehicle braked with 20 m/s^2";
  EXPECT_FALSE(prediction.isSurprising({poseAt(11.0, 0.0, 0.0)}, 2.1));
  pose.learn_velocity = false;
  prediction.accept(pose, 2.1);
  expectSamePose(prediction.predict(2.2), poseAt(3.0, 0.0, 0.0), 1e-12);
}

TEST(MotionPrediction, AfterALongTimeTheMotionIsUnknown) {
  MotionPrediction prediction = underWay();
  expectSamePose(prediction.predict(3601.0), poseAt(1.0, 0.0, 0.0), 1e-15);
  prediction.accept(poseAt(2.0, 0.0, 0.0), 3601.0);
  EXPECT_FALSE(prediction.state().velocity_known);
  EXPECT_GT(3.0 * std::sqrt(prediction.predictedCovariance(3601.1)(0, 0)), 4.0);  // 40 m/s
  prediction.accept(poseAt(3.0, 0.0, 0.0), 3601.1);
  expectSamePose(prediction.predict(3601.2), poseAt(4.0, 0.0, 0.0), 1e-9);
}

TEST(MotionPrediction, FreeDirectionsKeepThePredictionAndItsUncertainty) {
  MotionPrediction prediction = underWay();
  const PoseDirections along_x = Vector6d::Unit(0);
  double sigma_m = 0.0;
  for (int scan = 1; scan <= 20; ++scan) {
    const double stamp_s = 1.0 + 0.1 * scan;
    const Eigen::Isometry3d aligned = poseAt(1.0 + 0.4 * scan, 0.0, 0.0);
    const Eigen::Isometry3d kept = keptAlongFreeDirections(prediction.predict(stamp_s), aligned, along_x);
    expectSamePose(kept, poseAt(1.0 + 1.0 * scan, 0.0, 0.0), 1e-9);
    const Matrix6d covariance = prediction.accept({kept, Matrix6d::Zero(), along_x}, stamp_s);
    EXPECT_GT(std::sqrt(covariance(0, 0)), sigma_m);
    EXPECT_LT(std::sqrt(covariance(1, 1)), 1e-6);
    sigma_m = std::sqrt(covariance(0, 0));
  }
  EXPECT_GT(sigma_m, 0.5 * 3.0 * 2.0 * 2.0 * 0.9);  // what an acceleration of 3 m/s^2 does in 2 s
  EXPECT_LT(sigma_m, 0.5 * 3.0 * 2.0 * 2.0 * 1.5);
}

TEST(MotionPrediction, ResetForgets) {
  MotionPrediction prediction;
  prediction.accept(onCircle(0.0), 0.0);
  prediction.accept(onCircle(0.1), 0.1);
  prediction.reset(poseAt(7.0, 8.0, 0.2));
  EXPECT_FALSE(prediction.state().velocity_known);
  EXPECT_FALSE(prediction.state().timeSinceLast(0.2).has_value());
  expectSamePose(prediction.predict(0.2), poseAt(7.0, 8.0, 0.2), 1e-15);
  prediction.accept(poseAt(8.0, 8.0, 0.2), 0.2);
  EXPECT_FALSE(prediction.state().velocity_known);
}

TEST(MotionPrediction, KnowsNothingBeforeAPoseIsGiven) {
  const MotionPrediction prediction;
  EXPECT_EQ(prediction.state().status, TrackStatus::NOT_INITIALIZED);
  expectThrows<std::logic_error>([&] { prediction.predict(5.0); }, {"initial pose", "setInitialPose()"});
}

TEST(MotionPrediction, CoastsWhileScansAreRejectedAndIsLostAfterThree) {
  MotionPrediction prediction;
  prediction.reject(0.5);
  EXPECT_EQ(prediction.state().status, TrackStatus::NOT_INITIALIZED);
  prediction.accept(poseAt(0.0, 0.0, 0.0), 0.0);
  prediction.accept(poseAt(1.0, 0.0, 0.0), 0.1);
  EXPECT_EQ(prediction.state().status, TrackStatus::TRACKING);
  for (int scan = 1; scan <= 3; ++scan) {
    prediction.reject(0.5);
    EXPECT_EQ(prediction.state().status, scan < 3 ? TrackStatus::COASTING : TrackStatus::LOST);
    EXPECT_EQ(prediction.state().rejected_scans, scan);
  }
  expectSamePose(prediction.predict(0.4), poseAt(4.0, 0.0, 0.0), 1e-12);
  prediction.accept(poseAt(4.0, 0.0, 0.0), 0.4);
  EXPECT_EQ(prediction.state().status, TrackStatus::TRACKING);
  EXPECT_EQ(prediction.state().rejected_scans, 0);
}

TEST(MotionPrediction, RefusesWhatIsNoRigidTransform) {
  MotionPrediction prediction;
  Eigen::Isometry3d scaled = poseAt(1.0, 0.0, 0.0), mirrored = scaled;
  scaled.linear() *= 1.01;
  mirrored.linear() *= -1.0;
  for (const Eigen::Isometry3d& T : {scaled, mirrored}) {
    expectThrows<std::invalid_argument>([&] { prediction.reset(T); }, {"T_map_base", "rigid"});
  }
}

TEST(MotionPrediction, RefusesWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  MotionPrediction prediction;
  expectThrows<std::invalid_argument>([&] { prediction.reset(poseAt(0.0, nan, 0.0)); }, {"T_map_base"});
  expectThrows<std::invalid_argument>([&] { prediction.accept(poseAt(0.0, nan, 0.0), 1.0); }, {"T_map_base"});
  expectThrows<std::invalid_argument>([&] { prediction.accept(poseAt(0.0, 0.0, 0.0), nan); }, {"stamp_s"});
  expectThrows<std::invalid_argument>([&] { prediction.predict(nan); }, {"stamp_s"});
  for (const double value : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()}) {
    MotionPredictionOptions options;
    options.max_speed_mps = value;
    expectThrows<std::invalid_argument>([&] { MotionPrediction{options}; }, {"max_speed_mps = "});
    options = {};
    options.max_turn_rate_radps = value;
    expectThrows<std::invalid_argument>([&] { MotionPrediction{options}; }, {"max_turn_rate_radps = "});
    options = {};
    options.initial_sigma_m = value;
    expectThrows<std::invalid_argument>([&] { MotionPrediction{options}; }, {"initial_sigma_m = "});
    options = {};
    options.max_extrapolation_s = value;
    expectThrows<std::invalid_argument>([&] { MotionPrediction{options}; }, {"max_extrapolation_s = "});
  }
}

MeasuredMotion motionBetween(const Eigen::Isometry3d& before, const Eigen::Isometry3d& now, double sigma_m,
                             double sigma_rad) {
  MeasuredMotion motion;
  motion.T_before_now = before.inverse() * now;
  motion.covariance.diagonal() << Eigen::Vector3d::Constant(sigma_m * sigma_m),
      Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  return motion;
}

TEST(MotionPrediction, OdometryLeadsThroughRejectedScans) {
  MotionPrediction prediction;
  prediction.reset(onCircle(0.0));
  prediction.move(motionBetween(onCircle(-5.0), onCircle(0.0), 0.1, 0.1));  // led to the initial pose
  expectSamePose(prediction.predict(0.0), onCircle(0.0), 1e-12);
  prediction.accept(onCircle(0.0), 0.0);
  // Faster than before, and by stamps that say nothing.
  Eigen::Isometry3d last = onCircle(0.0);
  for (const double stamp_s : {1.0, 2.5, 4.5}) {
    prediction.move(motionBetween(last, onCircle(stamp_s), 0.1, 0.001));
    last = onCircle(stamp_s);
    expectSamePose(prediction.predict(0.1), last, 1e-9);
    prediction.reject(0.1);
  }
  // Errors that may be alike add up, each from one motion to the next: 0.1 m three times.
  const Matrix6d covariance = prediction.predictedCovariance(0.1);
  EXPECT_GT(std::sqrt(covariance(2, 2)), 0.29);
  EXPECT_LT(std::sqrt(covariance(2, 2)), 0.33);
  EXPECT_NEAR(std::sqrt(covariance(5, 5)), 0.003, 0.0003);
  prediction.accept(last, 0.2);
  // A scan without odometry: a constant velocity until the next pose.
  prediction.move(motionBetween(last, onCircle(5.0), 0.1, 0.001));
  prediction.reject(0.3);
  prediction.move(std::nullopt);
  const Eigen::Isometry3d by_velocity = prediction.predict(0.4);
  prediction.reject(0.4);
  prediction.move(motionBetween(onCircle(5.5), onCircle(6.0), 0.1, 0.001));
  EXPECT_GT((prediction.predict(0.5).translation() - onCircle(6.0).translation()).norm(), 1.0);
  MotionPrediction without;
  without.accept(onCircle(0.0), 0.0);
  without.accept(last, 0.2);
  expectSamePose(by_velocity, without.predict(0.4), 1e-9);
  prediction.accept(onCircle(6.0), 0.5);
  prediction.move(motionBetween(onCircle(6.0), onCircle(6.4), 0.1, 0.001));
  expectSamePose(prediction.predict(0.6), onCircle(6.4), 1e-9);
}

TEST(MotionPrediction, AWrongHeadingLeadsOdometryAstray) {
  MotionPrediction prediction;
  prediction.reset(poseAt(0.0, 0.0, 0.3));
  MeasuredPose pose{poseAt(0.0, 0.0, 0.3)};
  pose.covariance.diagonal().setConstant(1e-6);
  pose.covariance(5, 5) = 0.01 * 0.01;
  prediction.accept(pose, 0.0);
  prediction.move(motionBetween(poseAt(0.0, 0.0, 0.0), poseAt(50.0, 0.0, 0.0), 0.0, 0.0));
  const Eigen::Vector3d across(-std::sin(0.3), std::cos(0.3), 0.0);
  const Eigen::Matrix3d covariance = prediction.predictedCovariance(1.0).topLeftCorner<3, 3>();
  EXPECT_NEAR(std::sqrt(across.dot(covariance * across)), 0.5, 0.001);
}

TEST(MotionPrediction, APositionCorrectsWhatIsNotHeld) {
  MotionPrediction prediction;
  prediction.reset(poseAt(0.0, 0.0, 0.0));
  MeasuredPose pose{poseAt(10.0, 5.0, 0.0)};
  pose.covariance.diagonal() << 9.0, 1e-6, 1e-6, 1e-8, 1e-8, 1e-8;
  prediction.accept(pose, 0.0);
  MeasuredPosition position;
  position.position_m = {14.0, 6.0, 0.5};
  position.covariance.diagonal().setConstant(4.0);
  const Matrix6d covariance = prediction.correct(position);
  // The scalar Kalman filter along x; y is held, and moves by a millionth of the way.
  EXPECT_NEAR(prediction.state().T_map_base.translation().x(), 10.0 + 4.0 * 9.0 / 13.0, 1e-9);
  EXPECT_NEAR(prediction.state().T_map_base.translation().y(), 5.0, 1e-6);
  EXPECT_NEAR(covariance(0, 0), 9.0 * 4.0 / 13.0, 1e-9);
  EXPECT_NEAR(covariance(1, 1), 1e-6, 1e-11);
  // 30 m off is no position of this vehicle.
  const Eigen::Isometry3d before = prediction.state().T_map_base;
  position.position_m.x() += 30.0;
  EXPECT_EQ(prediction.correct(position), covariance);
  EXPECT_EQ(prediction.state().T_map_base.matrix(), before.matrix());
  position.position_m.x() = std::numeric_limits<double>::quiet_NaN();
  expectThrows<std::invalid_argument>([&] { prediction.correct(position); }, {"position"});
}

TEST(MotionPrediction, CorrectedPosesAreThoseOfAKalmanFilter) {
  UncertainPose pose{poseAt(1.0, 2.0, 0.1)};
  pose.covariance.diagonal() << 4.0, 1.0, 1.0, 1e-4, 1e-4, 1e-2;
  pose.covariance(1, 5) = pose.covariance(5, 1) = 0.05;  // who is too far left has turned too far left
  MeasuredPosition position;
  position.position_m = {2.0, 4.0, 0.5};
  position.covariance.diagonal().setConstant(1.0);
  const std::optional<UncertainPose> corrected = correctedBy(position, pose);
  ASSERT_TRUE(corrected);
  EXPECT_NEAR(corrected->T_map_base.translation().x(), 1.0 + 0.8, 1e-12);
  EXPECT_NEAR(corrected->T_map_base.translation().y(), 2.0 + 1.0, 1e-12);
  EXPECT_NEAR(heading(corrected->T_map_base), 0.1 + 0.05 / 2.0 * 2.0, 1e-12);
  EXPECT_NEAR(corrected->covariance(5, 5), 1e-2 - 0.05 * 0.05 / 2.0, 1e-12);
  position.position_m.x() = 100.0;
  EXPECT_FALSE(correctedBy(position, pose));
  // Where nothing is known, all is taken from the position.
  const auto anywhere = correctedBy(position, {poseAt(0.0, 0.0, 0.0), anywhereCovariance()});
  ASSERT_TRUE(anywhere);
  EXPECT_NEAR(anywhere->T_map_base.translation().x(), 100.0, 1e-6);
  EXPECT_NEAR(anywhere->covariance(0, 0), 1.0, 1e-6);
}

TEST(MotionPrediction, AnUnknownPoseIsLostUntilOneIsFound) {
  MotionPrediction prediction;
  prediction.resetUnknown();
  EXPECT_EQ(prediction.state().status, TrackStatus::LOST);
  EXPECT_FALSE(prediction.state().pose_known);
  prediction.reject(1.0);
  EXPECT_EQ(prediction.state().status, TrackStatus::LOST);
  EXPECT_TRUE(prediction.state().isLost());
  prediction.reject(1.05, true);
  EXPECT_EQ(prediction.state().status, TrackStatus::RELOCALIZING);
  EXPECT_TRUE(prediction.state().isLost());
  EXPECT_GT(prediction.predictedCovariance(1.1)(0, 0), 1e9);
  MeasuredPose pose{onCircle(1.2)};
  pose.covariance.diagonal().setConstant(1e-6);
  prediction.restart(pose, 1.2);
  EXPECT_EQ(prediction.state().status, TrackStatus::TRACKING);
  EXPECT_TRUE(prediction.state().pose_known);
  EXPECT_FALSE(prediction.state().velocity_known);
  EXPECT_EQ(prediction.state().stamp_s, 1.2);
  expectSamePose(prediction.predict(1.3), onCircle(1.2), 1e-12);
  // The speed is not known: a few metres a tenth of a second later.
  EXPECT_NEAR(std::sqrt(prediction.predictedCovariance(1.3)(0, 0)), 1.5, 0.1);
  prediction.accept(onCircle(1.3), 1.3);
  EXPECT_TRUE(prediction.state().velocity_known);
}

}  // namespace
}  // namespace saw_ndt
