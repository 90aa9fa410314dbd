#include <gtest/gtest.h>

#include "localization/scans_in_memory.h"
#include "localization/synthetic_drive.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/localization/localizer.h"

namespace saw_ndt {
namespace {

/// A room of 6 m x 4.4 m, 2.6 m high, with a table, a cupboard and a pillar.
std::vector<Block> roomBlocks() {
  return {{{3.1, -3, 0}, {3.3, 3, 3}},         {{-3.1, -3, 0}, {-2.9, 3, 3}},     {{-4, 2.1, 0}, {4, 2.3, 3}},
          {{-4, -2.5, 0}, {4, -2.3, 3}},       {{-4, -3, 2.6}, {4, 3, 2.8}},      {{0.8, 0.9, 0.7}, {2.2, 1.7, 0.75}},
          {{-2.9, -1.2, 0}, {-2.3, 0.1, 1.9}}, {{1.6, -1.9, 0}, {1.9, -1.6, 2.6}}};
}

/// The scans of a sensor that stands in the room, which differ by their noise alone.
SyntheticDrive standInTheRoom(const SensorModel& sensor, int scan_count, unsigned seed) {
  Eigen::Isometry3d T_ground_lidar = Eigen::Isometry3d::Identity();
  T_ground_lidar.translation() << 0.2, -0.1, 0.9;
  SyntheticDrive drive;
  for (int scan = 0; scan < scan_count; ++scan) {
    drive.stamps_s.push_back(0.1 * scan);
    drive.T_map_lidar.push_back(Eigen::Isometry3d::Identity());
    drive.scans.push_back(scanBlocks(roomBlocks(), sensor, T_ground_lidar, seed + static_cast<unsigned>(scan)));
  }
  return drive;
}

// Voxels are as large as the furniture here, and steps between two of them may go on for ever.
TEST(SmallRoom, EveryScanOfAStandingSensorConverges) {
  const SensorModel sensor = SensorModel::named("VLP-16");
  const SyntheticDrive drive = standInTheRoom(sensor, 12, 200);
  for (const double resolution_m : {0.2, 0.5, 1.0}) {
    DriveMapOptions map_options;
    map_options.resolution_m = resolution_m;
    map_options.segmentation->sensor = sensor;
    ScansInMemory map_scans(standInTheRoom(sensor, 12, 100));
    const WeightedVoxelMap map = buildDriveMap(map_scans, map_options).build();
    for (const std::string method : {"weighted", "classical"}) {
      LocalizerOptions options;
      options.method = LocalizationMethod::named(method);
      options.segmentation.sensor = sensor;
      Localizer localizer(map, options);
      localizer.setInitialPose(Eigen::Isometry3d::Identity());
      for (std::size_t scan = 0; scan < drive.scans.size(); ++scan) {
        SCOPED_TRACE(method + " in voxels of " + std::to_string(resolution_m) + " m, scan " + std::to_string(scan));
        const LocalizationResult result = localizer.localize(viewOf(drive.scans[scan]), drive.stamps_s[scan]);
        EXPECT_EQ(result.alignment.status, AlignmentStatus::CONVERGED) << toString(result.alignment.status);
        EXPECT_TRUE(result.accepted()) << toString(result.acceptance);
        // Where voxels cut the furniture, the map has no normal distributions: up to 3 mm.
        EXPECT_LT(result.T_map_base.translation().norm(), 0.005);
        EXPECT_LT(degreesFromRadians(rotationAngle(result.T_map_base.linear())), 0.1);
      }
    }
  }
}

}  // namespace
}  // namespace saw_ndt
