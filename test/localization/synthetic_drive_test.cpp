#include "synthetic_drive.h"

#include <gtest/gtest.h>

#include <memory>

#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/localization/localizer.h"
#include "saw_ndt/pcl/cloud_view.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

/// Every method follows the odd scans of a drive in the map of its even ones.
class SyntheticDriveTest : public ::testing::Test {
 protected:
  SyntheticDriveTest() : drive(driveDownTheStreet(sensor, 10)) {
    writeKittiDrive(folder.path(), drive);
    DriveMapOptions options;
    options.segmentation->sensor = sensor;
    map = buildDriveMap(*KittiSequence(folder.path()).scans({0, 2, 4, 6, 8}), options).build();
  }

  std::vector<LocalizationResult> localize(const std::string& method, int threads,
                                           const Eigen::Isometry3d& T_base_lidar = Eigen::Isometry3d::Identity()) {
    LocalizerOptions options;
    options.method = LocalizationMethod::named(method);
    options.segmentation.sensor = sensor;
    options.alignment.threads = threads;
    options.T_base_lidar = T_base_lidar;
    Localizer localizer(map, options);
    localizer.setInitialPose(drive.T_map_lidar[1] * T_base_lidar.inverse());
    std::vector<LocalizationResult> results;
    for (std::size_t i = 1; i < drive.scans.size(); i += 2) {
      results.push_back(localizer.localize(viewOf(drive.scans[i]), drive.stamps_s[i]));
    }
    return results;
  }

  void expectDriven(const std::vector<LocalizationResult>& results, const Eigen::Isometry3d& T_base_lidar) {
    for (std::size_t k = 0; k < results.size(); ++k) {
      ASSERT_TRUE(results[k].accepted()) << toString(results[k].acceptance);
      const Eigen::Isometry3d error = drive.T_map_lidar[2 * k + 1].inverse() * results[k].T_map_base * T_base_lidar;
      EXPECT_LT(error.translation().norm(), 0.01) << k;
      EXPECT_LT(degreesFromRadians(rotationAngle(error.linear())), 0.05) << k;
    }
  }

  SensorModel sensor = SensorModel::named("HDL-64E");
  TemporaryFolder folder;
  SyntheticDrive drive;
  WeightedVoxelMap map;
};

TEST_F(SyntheticDriveTest, EveryMethodFollows) {
  for (const std::string& method : LocalizationMethod::names()) {
    SCOPED_TRACE(method);
    const auto results = localize(method, 2);
    expectDriven(results, Eigen::Isometry3d::Identity());
    EXPECT_EQ(results.back().times.segment_ms > 0.0, method != "classical");
  }
}

TEST_F(SyntheticDriveTest, SegmentationIsDoneInTheFrameOfTheLidar) {
  Eigen::Isometry3d T_base_lidar = Eigen::Isometry3d::Identity();
  T_base_lidar.translation() << 0.9, 0.1, 1.7;
  T_base_lidar.linear() = rotationFromVector({0.3, 0.2, 1.5});
  expectDriven(localize("weighted", 2, T_base_lidar), T_base_lidar);
}

TEST_F(SyntheticDriveTest, ThreadsDoNotChangeABit) {
  for (const std::string method : {"weighted", "classical"}) {
    const auto expected = localize(method, 1);
    for (const int threads : {2, 4}) {
      const auto results = localize(method, threads);
      ASSERT_EQ(results.size(), expected.size());
      for (std::size_t k = 0; k < results.size(); ++k) {
        EXPECT_TRUE(results[k].T_map_base.matrix() == expected[k].T_map_base.matrix()) << method << k;
        EXPECT_TRUE(results[k].covariance == expected[k].covariance) << method << k;
        EXPECT_EQ(results[k].alignment.likelihoods.unweighted, expected[k].alignment.likelihoods.unweighted);
        EXPECT_EQ(results[k].alignment.likelihoods.non_ground, expected[k].alignment.likelihoods.non_ground);
        EXPECT_EQ(results[k].alignment.likelihoods.nearest_voxel, expected[k].alignment.likelihoods.nearest_voxel);
        EXPECT_EQ(results[k].alignment.likelihood, expected[k].alignment.likelihood);
        EXPECT_EQ(results[k].alignment.evaluations, expected[k].alignment.evaluations);
      }
    }
  }
}

}  // namespace
}  // namespace saw_ndt
