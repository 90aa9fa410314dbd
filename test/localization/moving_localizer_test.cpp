#include <gtest/gtest.h>

#include <memory>

#include "localization/synthetic_drive.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/localization/localizer.h"
#include "saw_ndt/map/weighted_map_builder.h"
#include "saw_ndt/segmentation/scan_segmenter.h"

namespace saw_ndt {
namespace {

constexpr double kSpeed_mps = 15.0;
constexpr int kScans = 8;

/// Drives of a LiDAR whose motion skews its scans by 0.75 m and 0.7 degrees, in a map of scans without skew.
class MovingLocalizer : public ::testing::Test {
 protected:
  static SensorModel sensor() { return SensorModel::named("HDL-64E"); }

  static void SetUpTestSuite() {
    const SyntheticDrive drive = raceDownTheStreet(sensor(), kScans, kSpeed_mps, 0.0, 1);
    SegmentationOptions segmentation;
    segmentation.sensor = sensor();
    WeightedMapBuilder builder(0.5, segmentation);
    ScanSegmenter segmenter(segmentation);
    std::vector<StructuralLabel> labels;
    for (std::size_t i = 0; i < drive.scans.size(); ++i) {
      segmenter.segment(viewOf(drive.scans[i]), labels);
      builder.addScan(viewOf(drive.scans[i]), LabelView(labels), drive.T_map_lidar[i]);
    }
    target = std::make_unique<NdtTarget>(builder.build(), LocalizationMethod::named("weighted").voxels);
    raw = std::make_unique<SyntheticDrive>(raceDownTheStreet(sensor(), kScans, kSpeed_mps, 0.1, 100));
    even = std::make_unique<SyntheticDrive>(raceDownTheStreet(sensor(), kScans, kSpeed_mps, 0.0, 200));
  }
  static void TearDownTestSuite() {
    target.reset();
    raw.reset();
    even.reset();
  }

  static LocalizerOptions optionsFor(MotionCompensation compensation) {
    LocalizerOptions options;
    options.segmentation.sensor = sensor();
    options.alignment.threads = 2;
    options.motion_compensation = compensation;
    return options;
  }

  /// @param unit  what a second is in the times of the points; 0: they have none
  static std::vector<LocalizationResult> localize(const SyntheticDrive& drive, const LocalizerOptions& options,
                                                  double unit = 0.0, double first_s = 0.0) {
    Localizer localizer(*target, options);
    localizer.setInitialPose(drive.T_map_lidar.front() * options.T_base_lidar.inverse());
    std::vector<LocalizationResult> results;
    for (std::size_t i = 0; i < drive.scans.size(); ++i) {
      ScanView view = viewOf(drive.scans[i]);
      std::vector<double> times;
      for (const double time_s : drive.times_s[i]) times.push_back(unit * (first_s + time_s));
      if (unit > 0.0) view.times_s = PointField(times.data());
      results.push_back(localizer.localize(view, drive.stamps_s[i]));
    }
    return results;
  }

  static double rmsError(const SyntheticDrive& drive, const std::vector<LocalizationResult>& results,
                         const Eigen::Isometry3d& T_base_lidar = Eigen::Isometry3d::Identity()) {
    double sum = 0.0;
    for (std::size_t i = 0; i < results.size(); ++i) {
      const Eigen::Isometry3d T_map_lidar = results[i].T_map_base * T_base_lidar;
      sum += (T_map_lidar.translation() - drive.T_map_lidar[i].translation()).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(results.size()));
  }
  static int acceptedOf(const std::vector<LocalizationResult>& results) {
    int accepted = 0;
    for (const LocalizationResult& result : results) accepted += result.accepted() ? 1 : 0;
    return accepted;
  }

  static std::unique_ptr<NdtTarget> target;
  static std::unique_ptr<SyntheticDrive> raw;   // skewed
  static std::unique_ptr<SyntheticDrive> even;  // not
};

std::unique_ptr<NdtTarget> MovingLocalizer::target;
std::unique_ptr<SyntheticDrive> MovingLocalizer::raw;
std::unique_ptr<SyntheticDrive> MovingLocalizer::even;

TEST_F(MovingLocalizer, FollowsSkewedScansAsWellAsOthersFromTheFirstScanOnWithoutKnowingItsSpeed) {
  const double error_of_even_m = rmsError(*even, localize(*even, optionsFor(MotionCompensation::OFF)));
  EXPECT_LT(error_of_even_m, 0.01);
  const auto results = localize(*raw, optionsFor(MotionCompensation::FROM_AZIMUTH_COUNTERCLOCKWISE));
  EXPECT_EQ(acceptedOf(results), kScans);
  EXPECT_LT(rmsError(*raw, results), 1.5 * error_of_even_m + 0.002);
  for (const LocalizationResult& result : results) EXPECT_TRUE(result.motion_compensated);
  EXPECT_GT(rmsError(*raw, localize(*raw, optionsFor(MotionCompensation::OFF))), 0.05);
}

TEST_F(MovingLocalizer, FollowsAClockwiseLidarAndOneThatIsMountedTurned) {
  const SyntheticDrive clockwise = raceDownTheStreet(sensor(), kScans, kSpeed_mps, -0.1, 300);
  LocalizerOptions options = optionsFor(MotionCompensation::FROM_AZIMUTH_CLOCKWISE);
  options.T_base_lidar.translation() << 0.9, 0.1, 1.7;
  options.T_base_lidar.linear() = rotationFromVector({0.02, 0.03, 1.5});
  const auto results = localize(clockwise, options);
  EXPECT_EQ(acceptedOf(results), kScans);
  EXPECT_LT(rmsError(clockwise, results, options.T_base_lidar), 0.015);
}

TEST_F(MovingLocalizer, TimesOfAnyUnitAndOriginGiveTheSamePoses) {
  const auto expected = localize(*raw, optionsFor(MotionCompensation::FROM_TIMES), 1.0);
  EXPECT_EQ(acceptedOf(expected), kScans);
  EXPECT_LT(rmsError(*raw, expected), 0.015);
  for (const double unit : {1e3, 1e9}) {
    const auto results = localize(*raw, optionsFor(MotionCompensation::FROM_TIMES), unit);
    for (std::size_t i = 0; i < results.size(); ++i) {
      EXPECT_LT((results[i].T_map_base.translation() - expected[i].T_map_base.translation()).norm(), 1e-3) << i;
    }
  }
}

TEST_F(MovingLocalizer, ScansWithoutTimesAreTakenAsTheyAre) {
  const auto expected = localize(*even, optionsFor(MotionCompensation::OFF));
  const auto results = localize(*even, optionsFor(MotionCompensation::FROM_TIMES));
  for (std::size_t i = 0; i < results.size(); ++i) {
    EXPECT_TRUE(results[i].T_map_base.matrix() == expected[i].T_map_base.matrix()) << i;
    EXPECT_FALSE(results[i].motion_compensated);
  }
}

TEST_F(MovingLocalizer, AStandingVehicleHasTheSamePosesToTheBit) {
  const SyntheticDrive standing = raceDownTheStreet(sensor(), 6, 0.0, 0.1, 400);
  const auto expected = localize(standing, optionsFor(MotionCompensation::OFF));
  EXPECT_EQ(acceptedOf(expected), 6);
  for (const MotionCompensation compensation :
       {MotionCompensation::FROM_AZIMUTH_COUNTERCLOCKWISE, MotionCompensation::FROM_AZIMUTH_CLOCKWISE,
        MotionCompensation::FROM_TIMES}) {
    const auto results = localize(standing, optionsFor(compensation), 1.0);
    for (std::size_t i = 0; i < results.size(); ++i) {
      EXPECT_TRUE(results[i].T_map_base.matrix() == expected[i].T_map_base.matrix()) << toString(compensation) << i;
      EXPECT_TRUE(results[i].covariance == expected[i].covariance) << toString(compensation) << i;
    }
  }
}

TEST_F(MovingLocalizer, ThreadsDoNotChangeABit) {
  LocalizerOptions options = optionsFor(MotionCompensation::FROM_AZIMUTH_COUNTERCLOCKWISE);
  const auto expected = localize(*raw, options);
  options.alignment.threads = 1;
  const auto results = localize(*raw, options);
  for (std::size_t i = 0; i < results.size(); ++i) {
    EXPECT_TRUE(results[i].T_map_base.matrix() == expected[i].T_map_base.matrix()) << i;
  }
}

}  // namespace
}  // namespace saw_ndt
