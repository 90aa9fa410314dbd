#include "report/pcl_ndt.h"

#include <gtest/gtest.h>

#include "expect_throws.h"
#include "localization/synthetic_drive.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "temporary_folder.h"

namespace saw_ndt {

using namespace internal;

namespace {

class PclNdtTest : public ::testing::Test {
 protected:
  PclNdtTest() {
    writeKittiDrive(folder.path() / "drive", drive);
    const KittiSequence sequence(folder.path() / "drive");
    target = mapPoints(*sequence.scans({0, 2, 4}));
    DriveMapOptions map_options;
    map_options.segmentation.reset();
    options.method = LocalizationMethod::named("classical");
    options.acceptance.min_likelihood = 0.0;
    judge = NdtTarget(buildDriveMap(*sequence.scans({0, 2, 4}), map_options).build());
  }

  Localizer localizer() const { return Localizer(pclNdtAligner(target, 1.0, judge), options); }

  TemporaryFolder folder;
  const SyntheticDrive drive = driveDownTheStreet(SensorModel::named("VLP-16"), 5);
  pcl::PointCloud<pcl::PointXYZ>::Ptr target;
  NdtTarget judge;
  LocalizerOptions options;
};

TEST_F(PclNdtTest, FindsThePoseOfAScan) {
  EXPECT_EQ(target->size(), drive.scans[0].size() + drive.scans[2].size() + drive.scans[4].size());
  Localizer localizer = this->localizer();
  for (const std::size_t i : {1, 4}) {
    // PCL does not find its way back from 0.5 m, which is how far the vehicle moves from scan to scan.
    Eigen::Isometry3d T_start = drive.T_map_lidar[i];
    T_start.translation().x() -= 0.2;
    localizer.setInitialPose(T_start);
    const LocalizationResult result = localizer.localize(viewOf(drive.scans[i]), drive.stamps_s[i]);
    EXPECT_TRUE(result.accepted()) << i;
    EXPECT_LT((result.T_map_base.translation() - drive.T_map_lidar[i].translation()).norm(), 0.05) << i;
    EXPECT_GT(result.source_points, 1000U);
    EXPECT_LT(result.source_points, drive.scans[i].size());
    EXPECT_GT(result.alignment.likelihoods.unweighted, 0.5);
    EXPECT_EQ(result.times.segment_ms, 0.0);
    EXPECT_GE(result.times.total_ms, result.times.filter_ms + result.times.align_ms);
  }
}

TEST_F(PclNdtTest, AMountedLidar) {
  options.T_base_lidar.translation() << 1.0, 0.2, 1.7;
  Localizer localizer = this->localizer();
  const Eigen::Isometry3d T_map_base = drive.T_map_lidar[1] * options.T_base_lidar.inverse();
  localizer.setInitialPose(T_map_base);
  const LocalizationResult result = localizer.localize(viewOf(drive.scans[1]), 0.1);
  EXPECT_LT((result.T_map_base.translation() - T_map_base.translation()).norm(), 0.05);
}

TEST_F(PclNdtTest, FarCorrectionsAreRejectedAndThePredictionStays) {
  options.acceptance.max_correction_m = 0.1;
  options.prediction.initial_sigma_m = 0.1;
  Localizer localizer = this->localizer();
  Eigen::Isometry3d T_start = drive.T_map_lidar[0];
  T_start.translation().x() += 0.5;
  localizer.setInitialPose(T_start);
  const LocalizationResult result = localizer.localize(viewOf(drive.scans[0]), 0.0);
  EXPECT_EQ(result.acceptance, Acceptance::LARGE_TRANSLATION);
  EXPECT_EQ(result.T_map_base.matrix(), T_start.matrix());
}

TEST_F(PclNdtTest, AnEmptyScanIsRejected) {
  Localizer localizer = this->localizer();
  localizer.setInitialPose(drive.T_map_lidar[0]);
  EXPECT_EQ(localizer.localize(ScanView(), 0.0).acceptance, Acceptance::NOT_CONVERGED);
}

TEST_F(PclNdtTest, RefusesWhatCannotWork) {
  expectThrows<std::invalid_argument>([&] { pclNdtAligner(nullptr, 1.0, judge); }, {"null"});
  expectThrows<std::invalid_argument>([&] { pclNdtAligner(target, 0.0, judge); }, {"resolution_m = 0"});
}

}  // namespace
}  // namespace saw_ndt
