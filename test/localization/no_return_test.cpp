#include <gtest/gtest.h>

#include "localization/scans_in_memory.h"
#include "localization/synthetic_drive.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/localization/localizer.h"

namespace saw_ndt {
namespace {

using Scan = std::vector<LidarPoint>;

/// A drive in the map of its even scans, of which one scan in the middle has next to no returns.
class ScanWithoutReturns : public ::testing::TestWithParam<const char*> {
 protected:
  static constexpr std::size_t kBadScan = 5;

  ScanWithoutReturns() {
    sensor.columns = 700;
    drive = driveDownTheStreet(sensor, 10);
    options.method = LocalizationMethod::named(GetParam());
    options.segmentation.sensor = sensor;
    const SyntheticDrive even = evenScansOf(drive);
    DriveMapOptions map_options;
    map_options.segmentation = options.segmentation;
    ScansInMemory map_scans(even);
    map = buildDriveMap(map_scans, map_options).build();
  }

  /// Localizes the odd scans, with another one in place of kBadScan.
  std::vector<LocalizationResult> localizeWith(const Scan& bad_scan) const {
    Localizer localizer(map, options);
    localizer.setInitialPose(drive.T_map_lidar[1]);
    std::vector<LocalizationResult> results;
    for (std::size_t scan = 1; scan < drive.scans.size(); scan += 2) {
      const Scan& points = scan == kBadScan ? bad_scan : drive.scans[scan];
      results.push_back(localizer.localize(viewOf(points), drive.stamps_s[scan]));
    }
    return results;
  }

  Eigen::Isometry3d errorOf(const std::vector<LocalizationResult>& results, std::size_t scan) const {
    return drive.T_map_lidar[scan].inverse() * results[scan / 2].T_map_base;
  }

  SensorModel sensor = SensorModel::named("HDL-64E");
  SyntheticDrive drive;
  LocalizerOptions options;
  WeightedVoxelMap map;
};

TEST_P(ScanWithoutReturns, IsRejectedAndLeavesTheTrackAsAnEmptyScanDoes) {
  const Scan& good = drive.scans[kBadScan];
  const std::vector<LocalizationResult> expected = localizeWith({});
  const Scan zeros(good.size()), one_point(good.size(), good[good.size() / 2]);
  for (const Scan& bad_scan : {zeros, one_point}) {
    const std::vector<LocalizationResult> results = localizeWith(bad_scan);
    const LocalizationResult& rejected = results[kBadScan / 2];
    EXPECT_FALSE(rejected.accepted());
    EXPECT_LE(rejected.source_points, 1U);
    EXPECT_TRUE(rejected.T_map_base.matrix() == rejected.T_map_base_predicted.matrix());
    EXPECT_EQ(rejected.track.status, TrackStatus::COASTING);
    for (std::size_t k = 0; k < results.size(); ++k) {
      EXPECT_TRUE(results[k].T_map_base.matrix() == expected[k].T_map_base.matrix()) << k;
      EXPECT_TRUE(results[k].covariance == expected[k].covariance) << k;
    }
    for (const std::size_t scan : {1U, 3U, 7U, 9U}) {
      EXPECT_TRUE(results[scan / 2].accepted()) << toString(results[scan / 2].acceptance);
      EXPECT_LT(errorOf(results, scan).translation().norm(), 0.01) << scan;
    }
    // The motion is a circle at constant speed, which the prediction follows from poses that are right to 1 cm.
    EXPECT_LT(errorOf(results, kBadScan).translation().norm(), 0.03);
  }
}

TEST_P(ScanWithoutReturns, WithAFewReturnsIsWhatTheseAre) {
  constexpr std::size_t kReturns = 200;
  Scan few_and_zeros = drive.scans[kBadScan], few;
  const std::size_t step = few_and_zeros.size() / kReturns;
  for (std::size_t i = 0; i < few_and_zeros.size(); ++i) {
    if (i % step == 0) {
      few.push_back(few_and_zeros[i]);
    } else {
      few_and_zeros[i] = LidarPoint();
    }
  }
  const std::vector<LocalizationResult> results = localizeWith(few_and_zeros), expected = localizeWith(few);
  for (std::size_t k = 0; k < results.size(); ++k) {
    EXPECT_EQ(results[k].source_points, expected[k].source_points);
    EXPECT_TRUE(results[k].T_map_base.matrix() == expected[k].T_map_base.matrix()) << k;
    EXPECT_TRUE(results[k].accepted()) << toString(results[k].acceptance);
  }
  // Two hundred returns with 1 cm of noise hold a pose to some millimetres.
  EXPECT_LT(errorOf(results, kBadScan).translation().norm(), 0.01);
}

INSTANTIATE_TEST_SUITE_P(Methods, ScanWithoutReturns, testing::Values("weighted", "classical"));

}  // namespace
}  // namespace saw_ndt
