#include "simulation/sequence_writer.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <stdexcept>

#include "expect_throws.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/io/trajectory.h"
#include "simple_scene.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

std::string contentOf(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(stream), {});
}

class SequenceWriterTest : public ::testing::Test {
 protected:
  SequenceWriterTest() {
    for (Eigen::Isometry3d& T : motion.T_scene_lidar) {
      T = Eigen::Translation3d(30.0, 5.0, 0.0) * T * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ());
    }
    options.sensor = SensorModel::named("VLP-16");
    options.firings_per_turn = 200;
  }

  TemporaryFolder folder;
  VehicleMotion motion = straightDrive(3, 12.0);
  Scene scene = sceneOf({ground(), block({2, 2, 2}, 1)}, {{40, 0.3F}, {50, 0.4F}});
  LidarOptions options;
};

TEST_F(SequenceWriterTest, ASequenceReadsBack) {
  LidarSimulator simulator(scene, options);
  int steps = 0;
  const SequenceContent content = writeSequence(folder.path(), simulator, motion, {}, [&] { ++steps; });
  EXPECT_EQ(steps, 3);
  EXPECT_EQ(content.scan_count, 3);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "poses_true.txt"));

  const KittiSequence sequence(folder.path());
  ASSERT_EQ(sequence.scanCount(), 3);
  std::size_t point_count = 0;
  for (int i = 0; i < 3; ++i) {
    const LidarScan scan = simulator.scan(motion, i);
    const auto points = sequence.readScan(i);
    ASSERT_EQ(points.size(), scan.points.size());
    point_count += points.size();
    for (std::size_t k = 0; k < points.size(); ++k) {
      EXPECT_EQ(positionOf(points[k]), positionOf(scan.points[k]));
      EXPECT_EQ(points[k].intensity, scan.points[k].intensity);
    }
    EXPECT_EQ(sequence.readLabels(i), scan.semantic_classes);
    // Stamps have 9 decimals; poses 13 digits, and pass twice through the calibration.
    EXPECT_NEAR(sequence.stamps()[i], motion.stamps_s[i], 1e-9);
    EXPECT_LT((sequence.posesLidar()[i].matrix() - motion.T_scene_lidar[i].matrix()).norm(), 1e-9);
  }
  EXPECT_EQ(content.point_count, point_count);
  EXPECT_LT((sequence.T_camera_lidar().matrix() - simulatedCalibration().matrix()).norm(), 1e-9);
}

TEST_F(SequenceWriterTest, TheReferenceIsWhatPosesState) {
  LidarSimulator simulator(scene, options);
  std::vector<Eigen::Isometry3d> reference = motion.T_scene_lidar;
  reference[1].translation().x() += 0.25;
  writeSequence(folder.path(), simulator, motion, reference);
  EXPECT_LT((KittiSequence(folder.path()).posesLidar()[1].matrix() - reference[1].matrix()).norm(), 1e-9);
  const KittiSequence truth(folder.path(), folder.path() / "poses_true.txt");
  EXPECT_LT((truth.posesLidar()[1].matrix() - motion.T_scene_lidar[1].matrix()).norm(), 1e-9);
}

TEST_F(SequenceWriterTest, TheSameInputGivesTheSameBytes) {
  const TemporaryFolder other;
  LidarSimulator one(scene, options, 1), two(scene, options, 2);
  writeSequence(folder.path(), one, motion);
  writeSequence(other.path(), two, motion);
  for (const char* name :
       {"velodyne/000000.bin", "velodyne/000002.bin", "labels/000001.label", "calib.txt", "times.txt", "poses.txt"}) {
    const std::string content = contentOf(folder.path() / name);
    EXPECT_FALSE(content.empty()) << name;
    EXPECT_EQ(content, contentOf(other.path() / name)) << name;
  }
}

TEST_F(SequenceWriterTest, NamesWhatIsWrong) {
  LidarSimulator simulator(scene, options);
  expectThrows<std::invalid_argument>([&] { writeSequence(folder.path(), simulator, VehicleMotion()); },
                                      {"motion.scanCount() = 0"});
  expectThrows<std::invalid_argument>(
      [&] { writeSequence(folder.path(), simulator, motion, {Eigen::Isometry3d::Identity()}); },
      {"reference.size() = 1"});
  const std::filesystem::path file = folder.write("file", "");
  expectThrows<Error>([&] { writeSequence(file, simulator, motion); }, {"file", "Not a directory"});
}

}  // namespace
}  // namespace saw_ndt
