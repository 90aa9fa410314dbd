#include "saw_ndt/drives/recording.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <sstream>

#include "expect_throws.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

constexpr int kScans = 3;

/// A scan of four floats a point, all of whose x tell the scan.
std::string binScan(int scan) {
  std::string bytes;
  for (int point = 0; point < 50; ++point) {
    const float values[] = {10.0F + static_cast<float>(scan), 0.25F * static_cast<float>(point), -1.5F, 0.5F};
    bytes.append(reinterpret_cast<const char*>(values), sizeof(values));
  }
  return bytes;
}

std::string pcdScan(int scan) {
  const std::string x = std::to_string(10 + scan);
  return "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n" +
         x + " 1 2\n" + x + " 3 4\n";
}

std::string numberName(int scan, const char* form) {
  char name[32];
  std::snprintf(name, sizeof(name), form, scan);
  return name;
}

void expectScansInOrder(const Recording& recording) {
  ASSERT_EQ(recording.scanCount(), kScans);
  for (int scan = 0; scan < kScans; ++scan) {
    ScanPoints points;
    recording.readScan(scan, points);
    EXPECT_EQ(points.points.front().x, 10.0F + static_cast<float>(scan)) << recording.scanName(scan);
  }
}

TEST(OpenRecording, FolderOfPcdFilesWhoseNamesAreStamps) {
  const TemporaryFolder folder;
  folder.write("9.900000001.pcd", pcdScan(0));
  folder.write("10.000000002.pcd", pcdScan(1));
  folder.write("100.1.pcd", pcdScan(2));
  folder.write("notes.md", "not a scan");
  const auto recording = openRecording(folder.path());
  expectScansInOrder(*recording);
  EXPECT_EQ(recording->stamps(), (std::vector<double>{9.900000001, 10.000000002, 100.1}));
  EXPECT_FALSE(recording->hasPoses());
  EXPECT_FALSE(recording->cameraCalibration().has_value());
  EXPECT_EQ(recording->scanName(1), "10.000000002.pcd");
}

TEST(OpenRecording, NumbersInNamesAreOrderedByValueAndStampsReadBesideOrAbove) {
  const TemporaryFolder folder;
  for (const int scan : {0, 1, 2}) folder.write("lidar/cloud_" + std::to_string(9 + scan) + ".pcd", pcdScan(scan));
  const auto without = openRecording(folder.path() / "lidar");
  expectScansInOrder(*without);
  EXPECT_FALSE(without->hasStamps());
  expectThrows<Error>([&] { without->stamps(); }, {"lidar", "has no stamps"});
  RecordingOptions at_rate;
  at_rate.scan_rate_hz = 4.0;
  EXPECT_EQ(openRecording(folder.path() / "lidar", at_rate)->stamps(), (std::vector<double>{0.0, 0.25, 0.5}));

  folder.write("times.txt", "5.5\n6\n7\n");
  EXPECT_EQ(openRecording(folder.path() / "lidar")->stamps(), (std::vector<double>{5.5, 6.0, 7.0}));
  EXPECT_EQ(openRecording(folder.path() / "lidar", at_rate)->stamps(), (std::vector<double>{5.5, 6.0, 7.0}));
  folder.write("times.txt", "5.5\n6\n");
  expectThrows<Error>([&] { openRecording(folder.path() / "lidar")->stamps(); }, {"times.txt", "2 times", "3 scans"});
}

TEST(OpenRecording, PosesWithStampsAreInterpolatedAndThoseOfKittiAreALineAScan) {
  const TemporaryFolder folder;
  for (const int scan : {0, 1, 2}) folder.write(std::to_string(scan) + ".pcd", pcdScan(scan));
  folder.write("times.txt", "0\n0.5\n9\n");
  folder.write("poses.txt", "-0.25 0 0 0 0 0 0 1\n0.25 1 0 0 0 0 0 1\n0.75 3 0 0 0 0 0 1\n");
  const auto recording = openRecording(folder.path());
  ASSERT_TRUE(recording->hasPoses());
  EXPECT_NEAR(recording->referencePose(0)->translation().x(), 0.5, 1e-12);
  EXPECT_NEAR(recording->referencePose(1)->translation().x(), 2.0, 1e-12);
  EXPECT_FALSE(recording->referencePose(2).has_value());
  EXPECT_EQ(recording->trajectory().size(), 2U);

  RecordingOptions options;
  options.poses_file =
      folder.write("kitti.txt", "1 0 0 7 0 1 0 0 0 0 1 0\n1 0 0 8 0 1 0 0 0 0 1 0\n1 0 0 9 0 1 0 0 0 0 1 0\n");
  EXPECT_EQ(openRecording(folder.path(), options)->referencePose(2)->translation(), Eigen::Vector3d(9, 0, 0));
  folder.write("calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");  // x of the camera is -y of the LiDAR
  EXPECT_LT((openRecording(folder.path(), options)->referencePose(2)->translation() - Eigen::Vector3d(0, -9, 0)).norm(),
            1e-12);
  options.poses_file = folder.write("kitti.txt", "1 0 0 7 0 1 0 0 0 0 1 0\n");
  expectThrows<Error>([&] { openRecording(folder.path(), options)->referencePose(0); },
                      {"kitti.txt", "1 poses", "3 scans"});
  options.poses_file = folder.path() / "none.txt";
  expectThrows<Error>([&] { openRecording(folder.path(), options); }, {"none.txt", "No such file"});
}

TEST(OpenRecording, KittiOdometryTakesPosesWithStampsToo) {
  const TemporaryFolder folder;
  for (int scan = 0; scan < kScans; ++scan) folder.write("velodyne/" + numberName(scan, "%06d.bin"), binScan(scan));
  folder.write("times.txt", "0\n0.5\n1\n");
  RecordingOptions options;
  options.poses_file = folder.write("tum.txt", "0 0 0 0 0 0 0 1\n1 4 0 0 0 0 0 1\n");
  const auto recording = openRecording(folder.path(), options);
  expectScansInOrder(*recording);
  EXPECT_NEAR(recording->referencePose(1)->translation().x(), 2.0, 1e-12);
}

/// Latitude and longitude, in degrees, where KITTI's projection of this scale has a place.
std::string oxtsLine(double east_m, double north_m, double yaw) {
  constexpr double kRadius_m = 6378137.0, kLatitude_deg = 49.0;
  const double scale_m = kRadius_m * std::cos(radiansFromDegrees(kLatitude_deg));
  const double origin_m = scale_m * std::log(std::tan(0.5 * radiansFromDegrees(90.0 + kLatitude_deg)));
  std::ostringstream line;
  line.precision(17);
  line << degreesFromRadians(2.0 * std::atan(std::exp((origin_m + north_m) / scale_m))) - 90.0 << ' '
       << 8.0 + degreesFromRadians(east_m / scale_m) << " 100 0 0 " << yaw;
  for (int i = 6; i < 30; ++i) line << " 0";
  return line.str() + '\n';
}

constexpr char kVeloToCam[] =
    "calib_time: 15-Mar-2012 11:37:16\nR: 0 -1 0 0 0 -1 1 0 0\nT: 0.1 0.2 0.3\ndelta_f: 0 0\n";

TEST(OpenRecording, KittiRawDriveHasStampsCalibrationAndPosesOfTheImu) {
  const TemporaryFolder folder;
  const std::string drive = "2011_09_26/2011_09_26_drive_0001_sync";
  for (int scan = 0; scan < kScans; ++scan) {
    folder.write(drive + "/velodyne_points/data/" + numberName(scan, "%010d.bin"), binScan(scan));
    if (scan == 1) continue;  // a record that is missing
    folder.write(drive + "/oxts/data/" + numberName(scan, "%010d.txt"), oxtsLine(3.0 * scan, 4.0 * scan, 0.1 * scan));
  }
  folder.write(drive + "/velodyne_points/timestamps.txt",
               "2011-09-26 13:02:25.1\n2011-09-26 13:02:25.2\n2011-09-26 13:02:25.3\n");
  folder.write("2011_09_26/calib_velo_to_cam.txt", kVeloToCam);
  folder.write("2011_09_26/calib_cam_to_cam.txt", "S_rect_00: 1242 375\nR_rect_00: 0 1 0 -1 0 0 0 0 1\n");
  folder.write("2011_09_26/calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: -0.8 0.3 -0.8\n");
  const auto recording = openRecording(folder.path() / drive);
  expectScansInOrder(*recording);
  EXPECT_EQ(recording->name(), "2011_09_26_drive_0001_sync");
  EXPECT_EQ(recording->stamps()[2], 1317042145.3);

  ASSERT_TRUE(recording->hasPoses());
  EXPECT_TRUE(recording->referencePose(0)->isApprox(Eigen::Isometry3d::Identity(), 1e-12));
  EXPECT_FALSE(recording->referencePose(1).has_value());
  Vector6d xyz_rpy, imu;
  xyz_rpy << 6.0, 8.0, 0.0, 0.0, 0.0, 0.2;
  imu << -0.8, 0.3, -0.8, 0.0, 0.0, 0.0;
  const Eigen::Isometry3d T_lidar_imu = transformFromXyzRpy(imu);
  const Eigen::Isometry3d expected = T_lidar_imu * transformFromXyzRpy(xyz_rpy) * T_lidar_imu.inverse();
  EXPECT_LT((recording->referencePose(2)->matrix() - expected.matrix()).cwiseAbs().maxCoeff(), 1e-7);

  const Eigen::Isometry3d T_camera_lidar = *recording->cameraCalibration();
  EXPECT_LT((T_camera_lidar * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0.2, -0.1, 1.3)).norm(), 1e-12);
}

TEST(OpenRecording, KittiTrackingSequenceIsTenScansASecond) {
  const TemporaryFolder folder;
  std::string oxts;
  for (int scan = 0; scan < kScans; ++scan) {
    folder.write("training/velodyne/0007/" + numberName(scan, "%06d.bin"), binScan(scan));
    oxts += oxtsLine(0.0, 5.0 * scan, 0.0);
  }
  folder.write("training/oxts/0007.txt", oxts);
  folder.write(
      "training/calib/0007.txt",
      "R_rect 1 0 0 0 1 0 0 0 1\nTr_velo_cam 0 -1 0 0 0 0 -1 0 1 0 0 0\nTr_imu_velo 1 0 0 0 0 1 0 0 0 0 1 0\n");
  const auto recording = openRecording(folder.path() / "training/velodyne/0007");
  expectScansInOrder(*recording);
  EXPECT_EQ(recording->stamps(), (std::vector<double>{0.0, 0.1, 0.2}));
  EXPECT_NEAR(recording->referencePose(2)->translation().y(), 10.0, 1e-6);
  EXPECT_TRUE(recording->cameraCalibration().has_value());
}

TEST(OpenRecording, WhatIsNoRecordingIsRefused) {
  const TemporaryFolder folder;
  expectThrows<Error>([&] { openRecording(folder.path() / "none"); }, {"none", "No such file"});
  expectThrows<Error>([&] { openRecording(folder.path()); }, {folder.path().string(), "holds no recording"});
  expectThrows<Error>([&] { openRecording(folder.write("a.txt", "hello")); }, {"a.txt", "is no recording"});
  folder.write("scans/a.pcd", pcdScan(0));
  folder.write("scans/a.ply", "ply\n");
  expectThrows<Error>([&] { openRecording(folder.path() / "scans"); }, {"scans", ".pcd and .ply"});
  RecordingOptions options;
  options.scan_rate_hz = -1.0;
  expectThrows<std::invalid_argument>([&] { openRecording(folder.path(), options); }, {"scan_rate_hz"});
}

}  // namespace
}  // namespace saw_ndt
