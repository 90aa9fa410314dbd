#include <gtest/gtest.h>

#include <sstream>

#include "apps/run_app_program.h"
#include "localization/synthetic_drive.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "temporary_folder.h"

namespace saw_ndt {

using namespace internal;

namespace {

TEST(LiveLocalizerExample, FollowsADriveByCloudsAndByArrays) {
  const TemporaryFolder folder;
  const SyntheticDrive drive = driveDownTheStreet(SensorModel::named("VLP-16"), 8);
  writeKittiDrive(folder.path(), drive);
  const KittiSequence sequence(folder.path());
  DriveMapOptions options;
  options.segmentation->sensor = SensorModel::named("VLP-16");
  const std::string map_file = (folder.path() / "drive.map").string();
  buildDriveMap(*sequence.scans({0, 1, 2, 3, 4, 5, 6, 7}), options).build().save(map_file);

  std::string arguments = map_file;
  for (int scan = 0; scan < sequence.scanCount(); ++scan) arguments += ' ' + sequence.scanPath(scan).string();
  const AppResult result = runAppProgram(SAW_NDT_LIVE_LOCALIZER, arguments);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  std::istringstream lines(result.output);
  std::size_t scan = 0;
  for (std::string line; std::getline(lines, line); ++scan) {
    ASSERT_LT(scan, drive.scans.size());
    EXPECT_NE(line.find(": tracking, position "), std::string::npos) << line;
    std::istringstream position(line.substr(line.find("position ") + 9));
    double x = 0.0, y = 0.0;
    position >> x >> y;
    EXPECT_NEAR(x, drive.T_map_lidar[scan].translation().x(), 0.02) << line;
    EXPECT_NEAR(y, drive.T_map_lidar[scan].translation().y(), 0.02) << line;
  }
  EXPECT_EQ(scan, drive.scans.size());
}

}  // namespace
}  // namespace saw_ndt
