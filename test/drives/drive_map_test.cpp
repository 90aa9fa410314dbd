#include "saw_ndt/drives/drive_map.h"

#include <gtest/gtest.h>

#include <atomic>

#include "expect_throws.h"
#include "localization/synthetic_drive.h"
#include "map/map_fixtures.h"
#include "real_data.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "temporary_folder.h"

namespace saw_ndt {

using namespace internal;

namespace {

class SequenceMap : public ::testing::Test {
 protected:
  void SetUp() override {
    if (realDataFolder().empty()) GTEST_SKIP() << "no real scans: set SAW_NDT_DATA to their folder";
  }

  std::string savedBytes(const std::vector<int>& scans, const DriveMapOptions& options) const {
    const KittiSequence sequence(realDataFolder() / "kitti" / "sequences" / "drive_0005");
    const std::string path = (folder.path() / "a.map").string();
    buildDriveMap(*sequence.scans(scans), options).build().save(path);
    return contentOf(path);
  }

  TemporaryFolder folder;
};

TEST_F(SequenceMap, ThreadsAndTheOrderOfScansDoNotChangeABit) {
  DriveMapOptions options;
  options.threads = 1;
  const std::string expected = savedBytes({0, 2, 4, 6}, options);
  EXPECT_GT(expected.size(), 100000U);
  options.threads = 2;
  EXPECT_TRUE(savedBytes({0, 2, 4, 6}, options) == expected);
  EXPECT_TRUE(savedBytes({4, 0, 6, 2}, options) == expected);
  options.segmentation.reset();
  const std::string raw = savedBytes({6, 4, 2, 0}, options);
  EXPECT_TRUE(raw != expected);
  options.threads = 4;
  EXPECT_TRUE(savedBytes({0, 2, 4, 6}, options) == raw);
}

TEST_F(SequenceMap, CountsScansAndReportsThem) {
  const KittiSequence sequence(realDataFolder() / "kitti" / "sequences" / "00");
  DriveMapOptions options;
  options.resolution_m = 2.0;
  std::atomic<int> done{0};
  const WeightedVoxelMap map = buildDriveMap(*sequence.scans({1, 3, 5}), options, [&] { ++done; }).build();
  EXPECT_EQ(done, 3);
  EXPECT_EQ(map.origin().scan_count, 3U);
  EXPECT_TRUE(map.labelled());
  EXPECT_EQ(map.resolution(), 2.0);
  EXPECT_GT(map.voxelCount(), 500U);
}

// Drivers write (0, 0, 0) where a beam met nothing. It is neither a voxel at the sensor nor a scan that met one, and
// rings are found as without.
TEST(SequenceMapOfSyntheticScans, PointsAtTheOriginOfTheLidarAreNoReturns) {
  const SensorModel sensor = SensorModel::named("VLP-16");
  SyntheticDrive drive = driveDownTheStreet(sensor, 2);
  for (const bool segmented : {true, false}) {
    DriveMapOptions options;
    options.segmentation->sensor = sensor;
    if (!segmented) options.segmentation.reset();
    const auto bytes = [&] {
      const TemporaryFolder folder;
      writeKittiDrive(folder.path(), drive);
      buildDriveMap(*KittiSequence(folder.path()).scans({0, 1}), options).build().save(folder.path() / "a.map");
      return contentOf(folder.path() / "a.map");
    };
    const std::string expected = bytes();
    const SyntheticDrive clean = drive;
    for (std::vector<LidarPoint>& scan : drive.scans) {
      for (std::size_t i = 0; i < scan.size(); i += 8) {
        scan.insert(scan.begin() + static_cast<std::ptrdiff_t>(i), LidarPoint());
      }
    }
    EXPECT_TRUE(bytes() == expected) << segmented;
    drive = clean;
  }
}

TEST(SequenceMapErrors, TheFirstBadScanIsNamed) {
  const TemporaryFolder folder;
  std::string four_points;
  for (int point = 0; point < 4; ++point) four_points += "1234567890123456";  // finite numbers
  for (const int scan : {0, 1, 2, 3, 4}) {
    const bool bad = scan == 1 || scan == 3;
    folder.write("velodyne/00000" + std::to_string(scan) + ".bin", bad ? "short" : four_points);
  }
  std::string poses;
  for (int scan = 0; scan < 5; ++scan) poses += "1 0 0 0 0 1 0 0 0 0 1 0\n";
  folder.write("poses.txt", poses);
  folder.write("calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
  const KittiSequence sequence(folder.path());
  for (const int threads : {1, 2, 4}) {
    DriveMapOptions options;
    options.threads = threads;
    expectThrows<Error>([&] { buildDriveMap(*sequence.scans({0, 1, 2, 3, 4}), options); }, {"000001.bin"});
    expectThrows<Error>([&] { buildDriveMap(*sequence.scans({4, 3, 2, 1, 0}), options); }, {"000003.bin"});
    EXPECT_EQ(buildDriveMap(*sequence.scans({0, 2, 4}), options).build().origin().point_count, 12U);

    std::vector<std::string> left_out;
    std::atomic<int> done{0};
    options.scan_left_out = [&](const std::string& failure) { left_out.push_back(failure); };
    const WeightedVoxelMap map = buildDriveMap(*sequence.scans({0, 1, 2, 3, 4}), options, [&] { ++done; }).build();
    EXPECT_EQ(map.origin().scan_count, 3U);
    EXPECT_EQ(done, 3);
    ASSERT_EQ(left_out.size(), 2U);
    EXPECT_NE(left_out[0].find("000001.bin"), std::string::npos) << left_out[0];
    EXPECT_NE(left_out[1].find("000003.bin"), std::string::npos) << left_out[1];
    expectThrows<Error>(
        [&] {
          buildDriveMap(*sequence.scans({1, 3}), options);
        },
        {"000003.bin", "no other scan is any better"});
  }
}

TEST(SequenceMapErrors, ScansWithoutAReferencePoseAreLeftOutAndAnErrorWhereThereIsNoOther) {
  const TemporaryFolder folder;
  folder.write("velodyne/000000.bin", "1234567890123456");
  DriveMapOptions options;
  const KittiSequence sequence(folder.path());
  expectThrows<Error>([&] { buildDriveMap(*sequence.scans({0}), options); }, {"000000.bin", "no reference pose"});
  std::vector<std::string> left_out;
  options.scan_left_out = [&](const std::string& failure) { left_out.push_back(failure); };
  expectThrows<Error>([&] { buildDriveMap(*sequence.scans({0}), options); },
                      {"000000.bin", "no reference pose", "no other scan is any better"});
  EXPECT_EQ(left_out.size(), 1U);
}

}  // namespace
}  // namespace saw_ndt
