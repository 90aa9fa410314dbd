#include <gtest/gtest.h>

#include <cmath>

#include "localization/scans_in_memory.h"
#include "localization/synthetic_drive.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/localization/localizer.h"

namespace saw_ndt {
namespace {

constexpr double kSpeed_mps = 20.0;
constexpr double kScanPeriod_s = 0.1;

/// A tunnel along x, 10 m wide and 5.8 m high, with a wall across it at either end: between them nothing holds x.
std::vector<Block> tunnelBlocks() {
  constexpr double kStart_m = -30.0, kEnd_m = 400.0;
  return {{{kStart_m, 5, 0}, {kEnd_m, 6, 6}},
          {{kStart_m, -6, 0}, {kEnd_m, -5, 6}},
          {{kStart_m, -6, 5.8}, {kEnd_m, 6, 6}},
          {{kStart_m - 1, -6, 0}, {kStart_m, 6, 6}},
          {{kEnd_m, -6, 0}, {kEnd_m + 1, 6, 6}}};
}

/// Two drives through one tunnel at the same speed, with other noise: one makes the map, the other is localized.
class DegeneratePlace : public ::testing::TestWithParam<const char*> {
 protected:
  DegeneratePlace() {
    sensor.columns = 512;
    options.method = LocalizationMethod::named(GetParam());
    options.segmentation.sensor = sensor;
    DriveMapOptions map_options;
    map_options.segmentation = options.segmentation;
    ScansInMemory map_scans(driveThrough(0, 50, 1000));
    map = buildDriveMap(map_scans, map_options).build();
  }

  /// Scans `first` to `last` of the drive; at scan 0 the end of the tunnel is 30 m behind.
  SyntheticDrive driveThrough(int first, int last, unsigned seed) const {
    constexpr double kSensorHeight_m = 1.8;
    const std::vector<Block> tunnel = tunnelBlocks();
    SyntheticDrive drive;
    for (int scan = first; scan < last; ++scan) {
      Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity(), T_ground_lidar = T_map_lidar;
      T_map_lidar.translation().x() = kSpeed_mps * kScanPeriod_s * scan;
      T_ground_lidar.translation() = T_map_lidar.translation() + Eigen::Vector3d(0.0, 0.0, kSensorHeight_m);
      drive.stamps_s.push_back(kScanPeriod_s * scan);
      drive.T_map_lidar.push_back(T_map_lidar);
      drive.scans.push_back(scanBlocks(tunnel, sensor, T_ground_lidar, seed + static_cast<unsigned>(scan)));
    }
    return drive;
  }

  /// Expects what holds with and without a known speed: x is right or free, and all the rest is right.
  void expectRightButForX(const LocalizationResult& result, const Eigen::Isometry3d& T_map_lidar) const {
    ASSERT_TRUE(result.accepted()) << toString(result.acceptance);
    const Eigen::Isometry3d error = T_map_lidar.inverse() * result.T_map_base;
    const double sigma_x_m = std::sqrt(result.covariance(0, 0));
    // Points have 1 cm of noise, and more than a thousand lie on each surface.
    EXPECT_LT(std::abs(error.translation().x()), result.free_directions.cols() > 0 ? 3.0 * sigma_x_m : 0.01);
    EXPECT_LT(error.translation().tail<2>().norm(), 0.005);
    EXPECT_LT(std::sqrt(result.covariance(1, 1)), 0.005);
    const Eigen::Vector3d turn = eulerFromRotation(error.linear());
    EXPECT_LT(degreesFromRadians(std::abs(turn.z())), 0.01);
    EXPECT_LT(degreesFromRadians(std::abs(turn.x())), 0.05);
    // A free direction of the map's voxels is x with a trace of pitch. A scan that was aligned tens of metres away
    // comes back along it, tilted.
    EXPECT_LT(degreesFromRadians(std::abs(turn.y())), 0.5);
  }

  SensorModel sensor = SensorModel::named("HDL-64E");
  LocalizerOptions options;
  WeightedVoxelMap map;
};

TEST_P(DegeneratePlace, ThePredictionMovesThePoseOnAlongTheFreeDirection) {
  Localizer localizer(map, options);
  const SyntheticDrive drive = driveThrough(0, 50, 2000);
  localizer.setInitialPose(drive.T_map_lidar.front());
  for (std::size_t scan = 0; scan < drive.scans.size(); ++scan) {
    SCOPED_TRACE(scan);
    const LocalizationResult result = localizer.localize(viewOf(drive.scans[scan]), drive.stamps_s[scan]);
    expectRightButForX(result, drive.T_map_lidar[scan]);
    // The wall behind is seen for 70 m, at last by a few beams.
    const std::string free = freeAxes(result.free_directions, result.T_map_base.linear());
    EXPECT_TRUE(free == "" || (free == "x" && scan > 10)) << free;
    EXPECT_TRUE(free == "x" || scan < 22) << free;
    // From poses that are sure to 4 mm the speed follows to 0.06 m/s, and three sigmas of it make 0.5 m in 3 s. A pose
    // that stays where the scans fit is 60 m behind at the end.
    EXPECT_NEAR(result.T_map_base.translation().x(), drive.T_map_lidar[scan].translation().x(), 0.5);
  }
  // Three seconds of an acceleration of 3 m/s^2 that may have been: 13.5 m.
  EXPECT_NEAR(std::sqrt(localizer.track().covariance(0, 0)), 13.5, 2.0);
}

TEST_P(DegeneratePlace, WhereNoSpeedIsKnownTheCovarianceHoldsTheWay) {
  Localizer localizer(map, options);
  const SyntheticDrive drive = driveThrough(28, 40, 2000);
  localizer.setInitialPose(drive.T_map_lidar.front());
  for (std::size_t scan = 0; scan < drive.scans.size(); ++scan) {
    SCOPED_TRACE(scan);
    const LocalizationResult result = localizer.localize(viewOf(drive.scans[scan]), drive.stamps_s[scan]);
    expectRightButForX(result, drive.T_map_lidar[scan]);
    EXPECT_EQ(freeAxes(result.free_directions, result.T_map_base.linear()), "x");
    // Not surer than the initial pose was.
    EXPECT_GT(std::sqrt(result.covariance(0, 0)), 0.99 * options.prediction.initial_sigma_m);
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, DegeneratePlace, testing::Values("weighted", "classical"));

}  // namespace
}  // namespace saw_ndt
