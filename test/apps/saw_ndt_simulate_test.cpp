#include "drive_files.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/io/trajectory.h"

namespace saw_ndt {
namespace {

class SimulateApp : public ::testing::Test {
 protected:
  static std::string quoted(const std::filesystem::path& path) { return "'" + path.string() + "' "; }
  AppResult simulate(const std::string& name, const std::string& more) const {
    return runAppProgram(SAW_NDT_APP, quoted(folder.path() / name) + "-sensor VLP-16 -objects 0.3 " + more);
  }
  void expectFails(int exit_code, std::initializer_list<std::string> parts, const std::string& more) const {
    const AppResult result = simulate("failed", more);
    EXPECT_EQ(result.exit_code, exit_code) << more;
    for (const std::string& part : parts) EXPECT_NE(result.errors.find(part), std::string::npos) << result.errors;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "failed")) << more;
  }

  TemporaryFolder folder;
};

TEST_F(SimulateApp, WritesASequenceThatReadsBack) {
  const AppResult result = simulate("a", "-scans 3 -scene rural");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("3 scans of rural, drive 1"), std::string::npos) << result.output;
  const KittiSequence sequence(folder.path() / "a");
  ASSERT_EQ(sequence.scanCount(), 3);
  EXPECT_EQ(sequence.posesLidar().size(), 3U);
  EXPECT_NEAR(sequence.stamps()[1] - sequence.stamps()[0], 0.1, 1e-9);
  for (int scan = 0; scan < 3; ++scan) {
    EXPECT_GT(sequence.readScan(scan).size(), 10000U);
    EXPECT_EQ(sequence.readLabels(scan).size(), sequence.readScan(scan).size());
  }
}

TEST_F(SimulateApp, OptionsAndNothingElseDecideTheBytes) {
  const auto scanOf = [this](const std::string& name) {
    return contentOf(folder.path() / name / "velodyne/000001.bin");
  };
  ASSERT_EQ(simulate("a", "-scans 2 -threads 1").exit_code, 0);
  ASSERT_EQ(simulate("b", "-scans 2 -threads 3").exit_code, 0);
  ASSERT_EQ(simulate("c", "-scans 2 -drive 2").exit_code, 0);
  ASSERT_EQ(simulate("d", "-scans 2 -rain 0.05").exit_code, 0);
  EXPECT_TRUE(scanOf("a") == scanOf("b"));
  EXPECT_FALSE(scanOf("a") == scanOf("c"));
  EXPECT_FALSE(scanOf("a") == scanOf("d"));
}

TEST_F(SimulateApp, DrivesATrajectoryAndStatesANoisyReference) {
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < 30; ++i) {
    poses.push_back(Eigen::Isometry3d::Identity());
    poses.back().translation().z() = 0.9 * i;  // a KITTI camera looks along z
  }
  writeKittiTrajectory(folder.path() / "poses.txt", poses);
  ASSERT_EQ(simulate("a", "-trajectory " + quoted(folder.path() / "poses.txt") + "-reference-noise 0.2").exit_code, 0);
  const KittiSequence sequence(folder.path() / "a");
  ASSERT_EQ(sequence.scanCount(), 30);
  const auto reference = sequence.posesLidar();
  const auto truth = KittiSequence(folder.path() / "a", folder.path() / "a" / "poses_true.txt").posesLidar();
  double greatest_m = 0.0;
  for (std::size_t i = 0; i < 30; ++i) {
    EXPECT_NEAR(truth[i].translation().x(), 0.9 * static_cast<double>(i), 0.1);
    greatest_m = std::max(greatest_m, (reference[i].translation() - truth[i].translation()).norm());
  }
  EXPECT_GT(greatest_m, 0.01);
  EXPECT_LT(greatest_m, 2.0);
}

TEST_F(SimulateApp, WrongUsageIsNamedAndLeavesNothing) {
  expectFails(2, {"-scene", "moon", "residential", "highway", "rural", "tunnel", "bridge", "plain", "equal_houses"},
              "-scene moon");
  expectFails(2, {"-times"}, "-times times.txt");
  expectFails(2, {"rain_share = 2"}, "-rain 2");
  expectFails(2, {"drive = 0"}, "-drive 0");
  expectFails(2, {"traffic_density = -1"}, "-traffic -1");
  expectFails(1, {"none.txt"}, "-trajectory none.txt");
  const auto scene = folder.write("bad.json", R"({"name": "bad", "speed": 3})");
  expectFails(1, {"bad.json", "speed", "unknown"}, "-scene " + quoted(scene));
}

TEST_F(SimulateApp, TakesBeamsFromAFileAndTheMountingOfTheLidar) {
  const auto sensor = folder.write("mine.json", R"({"name": "mine", "columns": 360, "elevations_deg": [2, -9, -20]})");
  const std::string options = "-objects 0.3 -scans 1 -sensor " + quoted(sensor);
  const auto run = [&](const std::string& name, const std::string& more) {
    return runAppProgram(SAW_NDT_APP, quoted(folder.path() / name) + options + more);
  };
  ASSERT_EQ(run("upright", "").exit_code, 0);
  ASSERT_EQ(run("hanging", "-mount-roll 180 -mount-pitch 10").exit_code, 0);
  const KittiSequence upright(folder.path() / "upright"), hanging(folder.path() / "hanging");
  EXPECT_LE(upright.readScan(0).size(), 3U * 360U);
  const Eigen::Matrix3d R = upright.posesLidar()[0].linear().transpose() * hanging.posesLidar()[0].linear();
  EXPECT_NEAR(R(2, 0), -std::sin(radiansFromDegrees(10.0)), 1e-6);
  EXPECT_NEAR(R(1, 1), -1.0, 1e-6);
  EXPECT_LT((upright.posesLidar()[0].translation() - hanging.posesLidar()[0].translation()).norm(), 1e-6);
}

TEST_F(SimulateApp, RefusesSensorsThatItCannotSimulate) {
  const auto refused = [&](const std::string& sensor) {
    return runAppProgram(SAW_NDT_APP, quoted(folder.path() / "failed") + "-scans 1 -sensor " + sensor);
  };
  EXPECT_NE(refused("M1").errors.find("sensor = M1"), std::string::npos) << refused("M1").errors;
  EXPECT_EQ(refused("M1").exit_code, 2);
  EXPECT_NE(refused("HDL-65").errors.find("VLS-128"), std::string::npos) << refused("HDL-65").errors;
  EXPECT_EQ(refused("HDL-65").exit_code, 2);
  EXPECT_NE(refused("none.json").errors.find("none.json"), std::string::npos) << refused("none.json").errors;
  EXPECT_EQ(refused("none.json").exit_code, 1);
}

TEST_F(SimulateApp, DoesNotMixWithASequenceThatIsThere) {
  ASSERT_EQ(simulate("a", "-scans 3").exit_code, 0);
  const auto before = filesIn(folder.path());
  const AppResult result = simulate("a", "-scans 2");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.errors.find("holds a sequence already"), std::string::npos) << result.errors;
  EXPECT_TRUE(filesIn(folder.path()) == before);
}

}  // namespace
}  // namespace saw_ndt
