#include <gtest/gtest.h>

#include <cmath>

#include "localization/scans_in_memory.h"
#include "localization/simulated_scans.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/localization/localizer.h"

namespace saw_ndt {
namespace {

// Guard rails, sound walls and the verge are parallel to the road: much of a scan fits metres behind and ahead as well.
TEST(WrongStart, AlongAMotorwayIsCorrectedOrRejectedUntilThePoseIsFound) {
  ScansInMemory map_scans(simulatedScans("highway", 1, 0, 70));
  const WeightedVoxelMap map = buildDriveMap(map_scans, {}).build();
  const SyntheticDrive drive = simulatedScans("highway", 2, 30, 45);
  for (const std::string method : {"weighted", "classical"}) {
    LocalizerOptions options;
    options.method = LocalizationMethod::named(method);
    for (const double ahead_m : {-20.0, -10.0, 10.0, 20.0}) {
      Localizer localizer(map, options);
      Eigen::Isometry3d start = drive.T_map_lidar.front();
      start.translation() += ahead_m * start.linear().col(0);
      localizer.setInitialPose(start);
      bool found = false;
      for (std::size_t scan = 0; scan < drive.scans.size(); ++scan) {
        SCOPED_TRACE(method + " from " + std::to_string(ahead_m) + " m ahead, scan " + std::to_string(scan));
        const LocalizationResult result = localizer.localize(viewOf(drive.scans[scan]), drive.stamps_s[scan]);
        const Eigen::Vector3d error_m = result.T_map_base.translation() - drive.T_map_lidar[scan].translation();
        const std::string free = freeAxes(result.free_directions, result.T_map_base.linear());
        if (!result.accepted()) continue;
        if (free.empty()) {
          EXPECT_LT(error_m.norm(), 0.05);
          EXPECT_LT(rotationAngle(result.T_map_base.linear().transpose() * drive.T_map_lidar[scan].linear()), 2e-3);
        } else {
          EXPECT_EQ(free, "x");
          EXPECT_LT(error_m.norm(), 3.0 * std::sqrt(result.covariance(0, 0)));
        }
        found = free.empty();
      }
      EXPECT_TRUE(found);
      EXPECT_EQ(localizer.track().status, TrackStatus::TRACKING);
    }
  }
}

}  // namespace
}  // namespace saw_ndt
