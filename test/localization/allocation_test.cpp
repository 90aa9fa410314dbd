#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "allocation_counter.h"
#include "localization/source_voxel_filter.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/localization/localizer.h"
#include "saw_ndt/pcl/cloud_view.h"
#include "synthetic_drive.h"
#include "temporary_folder.h"

namespace saw_ndt {

using namespace internal;

namespace {

TEST(Localizer, AllocatesNothingOfAScansSizeInTheSteadyState) {
  constexpr std::size_t kSettled = 6;
  const SensorModel sensor = SensorModel::named("VLP-16");
  const TemporaryFolder folder;
  const SyntheticDrive drive = driveDownTheStreet(sensor, 12);
  writeKittiDrive(folder.path(), drive);
  DriveMapOptions map_options;
  map_options.segmentation->sensor = sensor;
  const WeightedVoxelMap map =
      buildDriveMap(*KittiSequence(folder.path()).scans({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}), map_options).build();
  for (const std::string method : {"weighted", "classical"}) {
    LocalizerOptions options;
    options.method = LocalizationMethod::named(method);
    options.segmentation.sensor = sensor;
    options.alignment.threads = 1;
    Localizer localizer(map, options);
    localizer.setInitialPose(drive.T_map_lidar[0]);
    std::size_t before = 0;
    for (std::size_t i = 0; i < drive.scans.size(); ++i) {
      if (i == kSettled) before = allocated_bytes;
      const LocalizationResult result = localizer.localize(viewOf(drive.scans[i]), drive.stamps_s[i]);
      EXPECT_TRUE(result.accepted()) << method << " " << i << ": " << toString(result.acceptance);
    }
    EXPECT_LT((allocated_bytes - before) / (drive.scans.size() - kSettled), 2048U) << method;
  }
}

TEST(SourceVoxelFilter, AllocatesNothingInTheSteadyState) {
  std::vector<float> xyz;
  for (int i = 0; i < 200000; ++i) {
    const auto n = static_cast<float>(i);
    xyz.insert(xyz.end(), {0.3F * std::fmod(n, 400.0F), 0.001F * n, 1.0F});
  }
  ScanView scan;
  scan.xyz = xyz.data();
  scan.stride = 3;
  scan.size = xyz.size() / 3;
  const std::vector<StructuralLabel> labels(scan.size, StructuralLabel::NON_GROUND);
  SourceVoxelFilter filter(0.2);
  std::size_t before = 0;
  for (int round = 0; round < 3; ++round) {
    before = allocated_bytes;
    EXPECT_GT(filter.filter(scan, &labels).size(), 131072U / 2);  // beyond the first table
  }
  EXPECT_EQ(allocated_bytes - before, 0U);
}

}  // namespace
}  // namespace saw_ndt
