#include "saw_ndt/drives/motion_trial.h"

#include <gtest/gtest.h>

#include "drives/reference_motion.h"
#include "expect_throws.h"
#include "localization/scans_in_memory.h"
#include "real_data.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/drives/kitti_sequence.h"

namespace saw_ndt {

using namespace internal;

namespace {

SensorModel sensor() { return SensorModel::named("VLP-16"); }

/// @param signed_period_s  of a turn: 0.1 counterclockwise, -0.1 clockwise, 0 for scans without skew
SyntheticDrive driveOf(double speed_mps, double signed_period_s, unsigned seed) {
  return raceDownTheStreet(sensor(), 16, speed_mps, signed_period_s, seed);
}

DriveMapOptions mapOptionsFor(const SyntheticDrive& drive) {
  DriveMapOptions options;
  options.segmentation->sensor = sensor();
  options.threads = 2;
  for (std::size_t i = 0; i < drive.scans.size(); ++i) {
    options.trajectory.push_back({drive.stamps_s[i], drive.T_map_lidar[i]});
  }
  return options;
}

MotionTrial triedForAMap(const SyntheticDrive& drive, bool with_times = false) {
  ScansInMemory scans(drive, with_times);
  return tryMotionCompensation(mapOptionsFor(drive), scans);
}

TEST(MotionTrialTest, AMapOfSkewedScansIsCompensatedAndThatOfOthersIsNot) {
  const auto decided = [](double signed_period_s, bool with_times) {
    const MotionTrial trial = triedForAMap(driveOf(20.0, signed_period_s, 1), with_times);
    EXPECT_NE(trial.reason.find("as they are"), std::string::npos) << trial.reason;
    return trial.compensation;
  };
  EXPECT_EQ(decided(0.0, false), MotionCompensation::OFF);
  EXPECT_EQ(decided(0.1, false), MotionCompensation::FROM_AZIMUTH_COUNTERCLOCKWISE);
  EXPECT_EQ(decided(-0.1, false), MotionCompensation::FROM_AZIMUTH_CLOCKWISE);
  EXPECT_EQ(decided(0.1, true), MotionCompensation::FROM_TIMES);
}

// The times of a turn stay in the files of scans that are compensated already.
TEST(MotionTrialTest, TimesAloneAreNoReasonToCompensate) {
  SyntheticDrive drive = driveOf(20.0, 0.0, 1);
  drive.times_s = driveOf(20.0, 0.1, 1).times_s;
  for (std::size_t i = 0; i < drive.scans.size(); ++i) drive.times_s[i].resize(drive.scans[i].size());
  EXPECT_EQ(triedForAMap(drive, true).compensation, MotionCompensation::OFF);
}

TEST(MotionTrialTest, AVehicleThatStandsDoesNotTell) {
  const MotionTrial trial = triedForAMap(driveOf(0.0, 0.1, 1));
  EXPECT_EQ(trial.compensation, MotionCompensation::OFF);
  EXPECT_NE(trial.reason.find("too few scans of a moving vehicle"), std::string::npos) << trial.reason;
}

TEST(MotionTrialTest, LocalizingFindsOutInTheMap) {
  const SyntheticDrive of_map = driveOf(12.0, 0.0, 1);
  ScansInMemory map_scans(of_map);
  LocalizerOptions options;
  options.segmentation.sensor = sensor();
  options.alignment.threads = 2;
  const NdtTarget target(buildDriveMap(map_scans, mapOptionsFor(of_map)).build(), options.method.voxels);
  const auto decided = [&](const SyntheticDrive& drive, bool with_times) {
    ScansInMemory scans(drive, with_times);
    const MotionTrial trial = tryMotionCompensation(target, options, drive.T_map_lidar.front(), scans);
    EXPECT_FALSE(trial.reason.empty());
    return trial.compensation;
  };
  EXPECT_EQ(decided(driveOf(12.0, 0.0, 100), false), MotionCompensation::OFF);
  EXPECT_EQ(decided(driveOf(12.0, 0.1, 100), false), MotionCompensation::FROM_AZIMUTH_COUNTERCLOCKWISE);
  EXPECT_EQ(decided(driveOf(12.0, -0.1, 100), true), MotionCompensation::FROM_TIMES);
  EXPECT_EQ(decided(driveOf(0.0, 0.1, 100), false), MotionCompensation::OFF);  // too few that move
}

TEST(MotionTrialTest, ScansOfKittiOdometryAreCompensatedAlready) {
  if (realDataFolder().empty()) GTEST_SKIP() << "no real scans: set SAW_NDT_DATA to their folder";
  const KittiSequence sequence(realDataFolder() / "kitti" / "sequences" / "drive_0005");
  DriveMapOptions options;
  options.trajectory = sequence.trajectory();
  options.scan_period_s = sequence.scanPeriod();
  EXPECT_NEAR(options.scan_period_s, 0.1036, 1e-3);
  std::vector<int> numbers;
  for (int i = 0; i < sequence.scanCount(); ++i) numbers.push_back(i);
  EXPECT_EQ(tryMotionCompensation(options, *sequence.scans(numbers)).compensation, MotionCompensation::OFF);
}

TEST(CompensatedMap, OfSkewedScansIsNearlyThatOfOthers) {
  const SyntheticDrive even = driveOf(20.0, 0.0, 1), raw = driveOf(20.0, 0.1, 1);
  const auto mapFrom = [](const SyntheticDrive& drive, MotionCompensation compensation) {
    ScansInMemory scans(drive, compensation == MotionCompensation::FROM_TIMES);
    DriveMapOptions options = mapOptionsFor(drive);
    options.motion_compensation = compensation;
    return buildDriveMap(scans, options).build();
  };
  const auto voxels = [&](const SyntheticDrive& drive, MotionCompensation compensation) {
    return static_cast<double>(mapFrom(drive, compensation).voxelCount());
  };
  const double expected = voxels(even, MotionCompensation::OFF);
  EXPECT_NEAR(voxels(raw, MotionCompensation::FROM_AZIMUTH_COUNTERCLOCKWISE), expected, 0.05 * expected);
  EXPECT_NEAR(voxels(raw, MotionCompensation::FROM_TIMES), expected, 0.05 * expected);
  EXPECT_GT(std::abs(voxels(raw, MotionCompensation::OFF) - expected), 0.1 * expected);
}

TEST(CompensatedMap, WhatIsNotKnownIsAnError) {
  const SyntheticDrive drive = driveOf(20.0, 0.1, 1);
  DriveMapOptions options = mapOptionsFor(drive);
  options.motion_compensation = MotionCompensation::FROM_TIMES;
  ScansInMemory without_times(drive);
  expectThrows<Error>([&] { buildDriveMap(without_times, options); }, {"times of measurement"});
  options.trajectory.clear();
  ScansInMemory without_motion(drive, true);
  expectThrows<Error>([&] { buildDriveMap(without_motion, options); }, {"motion"});
  options.scan_period_s = 0.0;
  expectThrows<std::invalid_argument>([&] { options.check(); }, {"scan_period_s"});
}

// Rings that no sensor has are refused, so that it shows whether they are looked at.
class ScansOfStrangeRings : public ScansInMemory {
 public:
  using ScansInMemory::ScansInMemory;
  bool next(RecordedScan& scan) override {
    if (!ScansInMemory::next(scan)) return false;
    scan.rings.assign(scan.points.size(), 5000);
    return true;
  }
};

TEST(CompensatedMap, IsSegmentedByTheRingsOfItsScans) {
  const SyntheticDrive drive = driveOf(20.0, 0.1, 1);
  DriveMapOptions options = mapOptionsFor(drive);
  for (const MotionCompensation compensation :
       {MotionCompensation::OFF, MotionCompensation::FROM_AZIMUTH_COUNTERCLOCKWISE}) {
    options.motion_compensation = compensation;
    ScansOfStrangeRings scans(drive);
    expectThrows<std::invalid_argument>([&] { buildDriveMap(scans, options); }, {"ring 5000"});
  }
}

TEST(ReferenceMotion, LeadsFromPoseToPose) {
  const auto poseAt = [](double x) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation().x() = x;
    return T;
  };
  const std::vector<StampedPose> trajectory = {
      {0.0, poseAt(0.0)}, {0.1, poseAt(1.0)}, {0.2, poseAt(3.0)}, {5.0, poseAt(9.0)}, {9.0, poseAt(9.0)}};
  const auto speeds = [&](double stamp_s) {
    const auto motion = motionAt(trajectory, stamp_s);
    return motion ? std::vector<double>{motion->before.velocity_mps.x(), motion->after.velocity_mps.x()}
                  : std::vector<double>();
  };
  ASSERT_EQ(speeds(0.1).size(), 2U);
  EXPECT_NEAR(speeds(0.1)[0], 10.0, 1e-9);
  EXPECT_NEAR(speeds(0.1)[1], 20.0, 1e-9);
  EXPECT_NEAR(speeds(0.0)[0], 10.0, 1e-9);  // there is none before
  EXPECT_NEAR(speeds(0.2)[1], 20.0, 1e-9);  // the next is too late
  EXPECT_TRUE(speeds(5.0).empty());
  EXPECT_TRUE(speeds(0.15).empty());
}

}  // namespace
}  // namespace saw_ndt
