#include "saw_ndt/io/kitti.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <stdexcept>

#include "expect_throws.h"
#include "real_data.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/io/trajectory.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

template <typename Value>
std::string bytesOf(const std::vector<Value>& values) {
  std::string bytes(values.size() * sizeof(Value), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

const std::string kOnePoint = bytesOf<float>({1.0F, 2.0F, 3.0F, 0.5F});
// The camera's axes: right, down, forward.
constexpr char kCalibration[] = "P0: 1 2 3\nTr: 0 -1 0 0.1 0 0 -1 0.2 1 0 0 0.3\n";
constexpr char kPoses[] = "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 2\n";

class KittiSequenceTest : public ::testing::Test {
 protected:
  KittiSequenceTest() {
    data.write("sequences/07/velodyne/000000.bin", kOnePoint);
    data.write("sequences/07/velodyne/000001.bin", kOnePoint + kOnePoint);
    data.write("sequences/07/velodyne/readme.bin", "not a scan");
    data.write("sequences/07/calib.txt", kCalibration);
    data.write("sequences/07/times.txt", "0.0\n1.0e-1\n");
    data.write("poses/07.txt", kPoses);
  }

  TemporaryFolder data;
  std::filesystem::path folder = data.path() / "sequences" / "07";
};

TEST(KittiScan, ReadsPointsThatAreNotFiniteToo) {
  const TemporaryFolder folder;
  const auto scan = readKittiScan(folder.write("a.bin", kOnePoint));
  ASSERT_EQ(scan.size(), 1U);
  EXPECT_EQ(scan[0].x, 1.0F);
  EXPECT_EQ(scan[0].y, 2.0F);
  EXPECT_EQ(scan[0].z, 3.0F);
  EXPECT_EQ(scan[0].intensity, 0.5F);

  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto holed = readKittiScan(folder.write("b.bin", kOnePoint + bytesOf<float>({1.0F, nan, 3.0F, 0.5F})));
  ASSERT_EQ(holed.size(), 2U);
  EXPECT_TRUE(std::isnan(holed[1].y));
}

TEST(KittiScan, NamesFileAndOffsetOfDamage) {
  const TemporaryFolder folder;
  expectThrows<Error>([&] { readKittiScan(folder.write("a.bin", kOnePoint + "12345")); },
                      {"a.bin", "offset 16", "21 bytes"});
  expectThrows<Error>([&] { readKittiScan(folder.write("b.bin", "")); }, {"b.bin", "empty"});
  expectThrows<Error>([&] { readKittiScan(folder.path() / "c.bin"); }, {"c.bin", "No such file"});
}

TEST(KittiLabels, AreTheLowBits) {
  const TemporaryFolder folder;
  const auto path = folder.write("a.label", bytesOf<std::uint32_t>({40U, (7U << 16U) | 252U}));
  EXPECT_EQ(readSemanticKittiLabels(path), (std::vector<std::uint16_t>{40, 252}));
  expectThrows<Error>([&] { readSemanticKittiLabels(folder.write("b.label", "12345")); }, {"b.label", "offset 4"});
}

TEST(KittiScan, IsReadAsItWasWritten) {
  const TemporaryFolder folder;
  std::vector<LidarPoint> scan;
  for (int i = 0; i < 3; ++i) scan.push_back({1.0F + static_cast<float>(i), -0.1F, 1e-7F, 0.99F});
  writeKittiScan(folder.path() / "a.bin", scan);
  EXPECT_EQ(std::filesystem::file_size(folder.path() / "a.bin"), 48U);
  const auto read = readKittiScan(folder.path() / "a.bin");
  ASSERT_EQ(read.size(), scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i) {
    EXPECT_EQ(positionOf(read[i]), positionOf(scan[i]));
    EXPECT_EQ(read[i].intensity, scan[i].intensity);
  }
  expectThrows<Error>([&] { writeKittiScan(folder.path() / "none" / "a.bin", scan); }, {"none/a.bin"});
}

TEST(KittiLabels, AreReadAsTheyWereWritten) {
  const TemporaryFolder folder;
  const std::vector<std::uint16_t> classes = {0, 40, 259, 65535};
  writeSemanticKittiLabels(folder.path() / "a.label", classes);
  EXPECT_EQ(std::filesystem::file_size(folder.path() / "a.label"), 16U);
  EXPECT_EQ(readSemanticKittiLabels(folder.path() / "a.label"), classes);
}

TEST(KittiCalibration, IsReadAsItWasWritten) {
  const TemporaryFolder folder;
  Vector6d xyz_rpy;
  xyz_rpy << 0.1, -0.2, 0.3, -1.5, 0.01, -1.6;
  const Eigen::Isometry3d T_camera_lidar = transformFromXyzRpy(xyz_rpy);
  writeKittiCalibration(folder.path() / "calib.txt", T_camera_lidar);
  const Eigen::Isometry3d read = readKittiCalibration(folder.path() / "calib.txt");
  EXPECT_LT((read.matrix() - T_camera_lidar.matrix()).norm(), 1e-11);
}

TEST_F(KittiSequenceTest, ReadsTheLayout) {
  for (const auto& spelling : {folder, folder / "", folder / "."}) {
    const KittiSequence sequence(spelling);
    EXPECT_EQ(sequence.name(), "07");
    EXPECT_EQ(sequence.scanCount(), 2);
    EXPECT_TRUE(sequence.hasPoses());
    EXPECT_EQ(sequence.readScan(1).size(), 2U);
    EXPECT_EQ(sequence.stamps(), (std::vector<double>{0.0, 0.1}));
    // Two metres along the camera's z axis are two along the LiDAR's x axis.
    const std::vector<Eigen::Isometry3d> poses = sequence.posesLidar();
    ASSERT_EQ(poses.size(), 2U);
    EXPECT_LT((poses[0].matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-12);
    EXPECT_LT((poses[1].translation() - Eigen::Vector3d(2, 0, 0)).norm(), 1e-12);
  }
}

TEST_F(KittiSequenceTest, PosesBesideTheScansComeFirstAndANamedFileBeforeThem) {
  data.write("sequences/07/poses.txt", kPoses);
  EXPECT_EQ(KittiSequence(folder).posesFile(), folder / "poses.txt");
  EXPECT_EQ(KittiSequence(folder, data.path() / "poses/07.txt").posesFile(), data.path() / "poses/07.txt");
  expectThrows<Error>([&] { KittiSequence(folder, "none.txt"); }, {"none.txt", "No such file"});
}

// Data are often linked to where they are used.
TEST_F(KittiSequenceTest, BehindASymbolicLinkThePosesAreFound) {
  namespace fs = std::filesystem;
  // Poses beside the link, or beside what it leads to; another name; a link above.
  fs::create_directories(data.path() / "linked/sequences");
  fs::create_directory_symlink(folder, data.path() / "linked/sequences/run");
  const auto poses_of = [](const fs::path& path) { return fs::weakly_canonical(KittiSequence(path).posesFile()); };
  EXPECT_EQ(poses_of(data.path() / "linked/sequences/run"), fs::weakly_canonical(data.path() / "poses/07.txt"));
  EXPECT_EQ(poses_of(data.path() / "linked/sequences/run/"), fs::weakly_canonical(data.path() / "poses/07.txt"));
  data.write("linked/poses/run.txt", kPoses);
  EXPECT_EQ(poses_of(data.path() / "linked/sequences/run"), fs::weakly_canonical(data.path() / "linked/poses/run.txt"));
  EXPECT_EQ(KittiSequence(data.path() / "linked/sequences/run").name(), "run");
  fs::create_directory_symlink(data.path() / "sequences", data.path() / "linked/others");
  EXPECT_EQ(poses_of(data.path() / "linked/others/07"), fs::weakly_canonical(data.path() / "poses/07.txt"));
  EXPECT_EQ(KittiSequence(data.path() / "linked/others/07").posesLidar().size(), 2U);
}

TEST_F(KittiSequenceTest, NeedsOnlyWhatIsAskedFor) {
  std::filesystem::remove(folder / "calib.txt");
  std::filesystem::remove(folder / "times.txt");
  std::filesystem::remove(data.path() / "poses/07.txt");
  const KittiSequence sequence(folder);
  EXPECT_FALSE(sequence.hasPoses());
  EXPECT_EQ(sequence.readScan(0).size(), 1U);
  expectThrows<Error>([&] { sequence.posesLidar(); }, {(folder / "poses.txt").string(), "poses/07.txt"});
  expectThrows<Error>([&] { sequence.stamps(); }, {"times.txt", "No such file"});
  expectThrows<Error>([&] { sequence.T_camera_lidar(); }, {"calib.txt", "No such file"});
}

TEST_F(KittiSequenceTest, LinesBelongToFileNumbersWhereTheyCoverTheWholeDrive) {
  std::filesystem::rename(folder / "velodyne/000001.bin", folder / "velodyne/000003.bin");
  EXPECT_EQ(KittiSequence(folder).stamps(), (std::vector<double>{0.0, 0.1}));
  data.write("sequences/07/times.txt", "0\n1\n2\n3\n4\n");
  EXPECT_EQ(KittiSequence(folder).stamps(), (std::vector<double>{0.0, 3.0}));
  data.write("sequences/07/times.txt", "0\n1\n2\n");
  expectThrows<Error>([&] { KittiSequence(folder).stamps(); }, {"times.txt", "3 times", "need 4"});
}

TEST_F(KittiSequenceTest, ANumberThatIsTheGreatestHasNoLine) {
  const std::string greatest = std::to_string(std::numeric_limits<unsigned long long>::max());
  std::filesystem::rename(folder / "velodyne/000001.bin", folder / ("velodyne/" + greatest + ".bin"));
  data.write("sequences/07/times.txt", "0\n1\n2\n3\n");
  data.write("poses/07.txt", std::string(kPoses) + kPoses);
  const KittiSequence sequence(folder);
  EXPECT_EQ(sequence.scanName(1), greatest + ".bin");
  expectThrows<Error>([&] { sequence.stamps(); }, {"times.txt", "4 times", "need " + greatest});
  expectThrows<Error>([&] { sequence.posesLidar(); }, {"07.txt", "4 poses", "need " + greatest});
}

TEST_F(KittiSequenceTest, NamesWhatIsTooShort) {
  data.write("sequences/07/times.txt", "0.0\n");
  data.write("poses/07.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  data.write("sequences/07/labels/000001.label", bytesOf<std::uint32_t>({40U}));
  const KittiSequence sequence(folder);
  expectThrows<Error>([&] { sequence.stamps(); }, {"times.txt", "1 times", "need 2"});
  expectThrows<Error>([&] { sequence.posesLidar(); }, {"07.txt", "1 poses", "need 2"});
  expectThrows<Error>([&] { sequence.readLabels(1); }, {"000001.label", "1 labels", "2 points"});
  expectThrows<Error>([&] { sequence.readLabels(0); }, {"000000.label", "No such file"});
  std::filesystem::remove(folder / "velodyne/000001.bin");
  expectThrows<Error>([&] { sequence.readScan(1); }, {"000001.bin", "No such file"});
  expectThrows<std::out_of_range>([&] { sequence.readScan(2); }, {"scan 2", "0 to 1"});
  expectThrows<std::out_of_range>([&] { sequence.readScan(-1); }, {"scan -1"});
}

TEST_F(KittiSequenceTest, NamesLinesThatAreWrong) {
  const KittiSequence sequence(folder);
  data.write("poses/07.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 2 0 0 0 0 1 0\n");
  expectThrows<Error>([&] { sequence.posesLidar(); }, {"07.txt", "line 2", "no rigid transform"});
  data.write("sequences/07/times.txt", "0.0\n0.1.2\n");
  expectThrows<Error>([&] { sequence.stamps(); }, {"times.txt", "line 2", "'0.1.2'"});
}

TEST_F(KittiSequenceTest, CalibrationErrors) {
  const KittiSequence sequence(folder);
  const auto path = data.write("sequences/07/calib.txt", "P0: 1 2 3\nTr_velo_to_cam: 0 -1 0 0.1 0 0 -1 0.2 1 0 0 0.3");
  EXPECT_EQ(sequence.T_camera_lidar().translation(), Eigen::Vector3d(0.1, 0.2, 0.3));
  data.write("sequences/07/calib.txt", "P0: 1 2 3\n");
  expectThrows<Error>([&] { sequence.T_camera_lidar(); }, {path.string(), "no line Tr"});
  data.write("sequences/07/calib.txt", "P0: 1\nTr: 0 -1 0\n");
  expectThrows<Error>([&] { sequence.T_camera_lidar(); }, {path.string(), "line 2", "3 numbers, where 12"});
  data.write("sequences/07/calib.txt", "Tr: 0 -1 0 0.1 0 0 -1 0.2 1 0 zero 0.3\n");
  expectThrows<Error>([&] { sequence.T_camera_lidar(); }, {path.string(), "line 1", "'zero'"});
}

TEST(KittiSequence, RefusesAFolderWithoutScans) {
  const TemporaryFolder data;
  expectThrows<Error>([&] { KittiSequence(data.path() / "none"); }, {"none", "No such file"});
  expectThrows<Error>([&] { KittiSequence(data.path()); }, {"velodyne", "No such file"});
  std::filesystem::create_directories(data.path() / "velodyne");
  expectThrows<Error>([&] { KittiSequence(data.path()); }, {"velodyne", "no numbered .bin file"});
}

TEST(KittiSequence, ReadsRealDrives) {
  const std::filesystem::path kitti = realDataFolder() / "kitti";
  if (!std::filesystem::exists(kitti)) GTEST_SKIP() << "no real data at " << kitti;
  const struct {
    const char* name;
    int scan_count;
  } drives[] = {{"drive_0005", 70}, {"00", 10}, {"01", 10}, {"03", 10}};
  for (const auto& drive : drives) {
    SCOPED_TRACE(drive.name);
    const KittiSequence sequence(kitti / "sequences" / drive.name);
    EXPECT_EQ(sequence.scanCount(), drive.scan_count);
    EXPECT_EQ(sequence.stamps().size(), static_cast<std::size_t>(drive.scan_count));
    EXPECT_GT(sequence.readScan(0).size(), 50000U);
    const std::vector<Eigen::Isometry3d> P = readKittiTrajectory(sequence.posesFile());
    const std::vector<Eigen::Isometry3d> T = sequence.posesLidar();
    const Eigen::Isometry3d Tr = sequence.T_camera_lidar();
    ASSERT_EQ(T.size(), P.size());
    EXPECT_LT(T.front().translation().norm(), 1e-6);
    EXPECT_GT(T.back().translation().x(), 1.0);
    for (std::size_t i = 0; i < T.size(); ++i) {
      EXPECT_LT((P[i].matrix() - (Tr * T[i] * Tr.inverse()).matrix()).norm(), 1e-6);
    }
    if (std::filesystem::exists(sequence.labelPath(0))) {
      EXPECT_EQ(sequence.readLabels(0).size(), sequence.readScan(0).size());
    }
  }
}

}  // namespace
}  // namespace saw_ndt
