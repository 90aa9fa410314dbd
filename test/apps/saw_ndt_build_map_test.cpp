#include "drive_files.h"
#include "saw_ndt/map/weighted_voxel_map.h"
#include "saw_ndt/version.h"

namespace saw_ndt {
namespace {

class BuildMapApp : public DriveFiles {
 protected:
  AppResult build(const std::string& more = "") const {
    return runAppProgram(SAW_NDT_APP, quoted(drive_folder) + quoted(map_file) + kSensor + more);
  }
  void expectBuildFails(int exit_code, std::initializer_list<std::string> parts, const std::string& more = "") const {
    expectFails(SAW_NDT_APP, quoted(drive_folder) + quoted(map_file) + kSensor + more, exit_code, parts);
  }

  const std::filesystem::path map_file = folder.path() / "a.map";
};

TEST_F(BuildMapApp, BuildsAMapThatLoads) {
  const AppResult result = build("-scans 0:6:2 -resolution 0.8");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.errors, "");
  EXPECT_NE(result.output.find("of 3 scans"), std::string::npos) << result.output;
  const WeightedVoxelMap map = WeightedVoxelMap::load(map_file);
  EXPECT_TRUE(map.labelled());
  EXPECT_EQ(map.resolution(), 0.8);
  EXPECT_EQ(map.origin().scan_count, 3U);
  EXPECT_GT(map.voxelCount(), 500U);
  ASSERT_TRUE(map.origin().segmentation);
  EXPECT_EQ(map.origin().segmentation->sensor.name, "VLP-16");
  EXPECT_EQ(map.origin().software_version, SAW_NDT_VERSION);
  EXPECT_EQ(folder.entryCount(), 2U);
}

TEST_F(BuildMapApp, ClassicalMapsHaveNoLabels) {
  ASSERT_EQ(build("-classical").exit_code, 0);
  const WeightedVoxelMap map = WeightedVoxelMap::load(map_file);
  EXPECT_FALSE(map.labelled());
  EXPECT_FALSE(map.origin().segmentation);
}

TEST_F(BuildMapApp, ThreadsAndOrderDoNotChangeABit) {
  ASSERT_EQ(build("-scans 0:6:2").exit_code, 0);
  const std::string expected = contentOf(map_file);
  const std::string others = quoted(drive_folder) + quoted(map_file) + "-sensor VLP-16 -threads 3 -scans 4::-2";
  ASSERT_EQ(runAppProgram(SAW_NDT_APP, others).exit_code, 0);
  EXPECT_TRUE(contentOf(map_file) == expected);
}

TEST_F(BuildMapApp, AScanThatCannotBeReadIsLeftOutAndTheOthersAreKept) {
  const std::string scan = contentOf(drive_folder / "velodyne" / "000000.bin");
  ASSERT_EQ(build("-scans 1:").exit_code, 0);
  const std::string expected = contentOf(map_file);
  const std::pair<std::string, std::string> damages[] = {{scan.substr(0, 1003), "000000.bin: offset 992: "},
                                                         {"", "000000.bin: offset 0: the file is empty"}};
  for (const auto& [content, reason] : damages) {
    replace("velodyne/000000.bin", content);
    const AppResult result = build();
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_NE(result.errors.find("saw_ndt_build_map: "), std::string::npos) << result.errors;
    EXPECT_NE(result.errors.find(reason), std::string::npos) << result.errors;
    EXPECT_NE(result.errors.find(": left out\n"), std::string::npos) << result.errors;
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
    EXPECT_NE(result.output.find("of 5 scans, 1 left out\n"), std::string::npos) << result.output;
    EXPECT_TRUE(contentOf(map_file) == expected);
  }
}

TEST_F(BuildMapApp, WrongUsageIsNamed) {
  expectBuildFails(2, {"-resolution"}, "-resolution fine");
  expectBuildFails(2, {"resolution", "-1"}, "-resolution -1");
  expectBuildFails(2, {"scan selection '7:'"}, "-scans 7:");
  expectBuildFails(2, {"mounting_pitch_deg"}, "-mounting-pitch-deg 120");
  expectBuildFails(2, {"-max-speed"}, "-max-speed 3");
  expectFails(SAW_NDT_APP, quoted(drive_folder), 2, {"missing MAP"});
  expectFails(SAW_NDT_APP, quoted(drive_folder) + quoted(map_file) + "-sensor HDL-1", 2, {"-sensor", "HDL-1"});
}

TEST_F(BuildMapApp, AnInstructionSetThatThereIsNotIsNamed) {
  setenv("SAW_NDT_INSTRUCTION_SET", "fastest", 1);
  expectBuildFails(1, {"SAW_NDT_INSTRUCTION_SET", "fastest"});
  unsetenv("SAW_NDT_INSTRUCTION_SET");
}

TEST_F(BuildMapApp, FailuresNameTheFileAndLeaveAnOldMapAlone) {
  folder.write("a.map", "an old map");
  expectFails(SAW_NDT_APP, quoted(folder.path() / "none") + quoted(map_file), 1, {"none: No such file"});
  expectFails(SAW_NDT_APP, quoted(drive_folder) + quoted(folder.path() / "no" / "a.map"), 1, {"a.map: No such file"});
  expectFails(SAW_NDT_APP, quoted(drive_folder) + quoted(drive_folder), 1, {"drive: Is a directory"});
  expectBuildFails(1, {"none.txt: No such file"}, "-poses none.txt");

  const std::string poses = contentOf(drive_folder / "poses.txt");
  replace("poses.txt", poses.substr(0, poses.rfind('\n', poses.size() - 2) + 1));
  expectBuildFails(1, {"poses.txt: 5 poses", "6"});
  replace("poses.txt", "1 0 0 0 0 1 0 0 0 0 1\n" + poses);
  expectBuildFails(1, {"poses.txt: line 1", "11 numbers"});
  std::filesystem::remove(drive_folder / "poses.txt");
  expectBuildFails(1, {"poses.txt: no poses"});
  replace("poses.txt", poses);

  const std::string scan = contentOf(drive_folder / "velodyne" / "000003.bin");
  replace("velodyne/000003.bin", scan.substr(0, 1003));
  expectBuildFails(1, {"000003.bin: offset 992"}, "-strict");
  replace("velodyne/000003.bin", "");
  expectBuildFails(1, {"000003.bin: offset 0: the file is empty"}, "-strict");
  expectBuildFails(1, {"000003.bin: offset 0: the file is empty, and no other scan"}, "-scans 3");
  replace("velodyne/000003.bin", scan);

  replace("calib.txt", "P0: 1 0 0 0 0 1 0 0 0 0 1 0\n");
  expectBuildFails(1, {"calib.txt: no line Tr"});
  std::filesystem::remove(drive_folder / "calib.txt");
  expectBuildFails(1, {"calib.txt: No such file"});
}

}  // namespace
}  // namespace saw_ndt
