#include "drive_files.h"
#include "saw_ndt/map/map_update.h"
#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt {
namespace {

class MapMergeApp : public DriveFiles {
 protected:
  std::string path(const std::string& name) const { return quoted(folder.path() / name); }

  void build(const std::string& name, const std::string& more) const {
    const AppResult result =
        runAppProgram(SAW_NDT_BUILD_MAP_APP, quoted(drive_folder) + path(name) + "-threads 2 " + more);
    ASSERT_EQ(result.exit_code, 0) << result.errors;
  }
  std::string bytesOf(const std::string& name) const { return contentOf(folder.path() / name); }
};

TEST_F(MapMergeApp, ShardsMergeIntoTheBytesOfTheWholeInAnyOrder) {
  // What is learned is learned of the whole selection: the sensor, its mounting and the motion, too.
  for (const std::string selection : {"", "-scans 5::-1 ", "-classical "}) {
    SCOPED_TRACE(selection);
    build("whole.map", selection);
    for (const std::string shard : {"1/3", "2/3", "3/3"})
      build(shard.substr(0, 1) + ".map", selection + "-shard " + shard);
    EXPECT_EQ(WeightedVoxelMap::load(folder.path() / "2.map").origin().scan_count, 2U);
    const AppResult result =
        runAppProgram(SAW_NDT_APP, path("merged.map") + path("1.map") + path("2.map") + path("3.map"));
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(result.errors, "");
    EXPECT_NE(result.output.find("of 6 scans of 3 maps\n"), std::string::npos) << result.output;
    EXPECT_TRUE(bytesOf("merged.map") == bytesOf("whole.map"));
    // Step by step, in another order and into one of the inputs.
    ASSERT_EQ(runAppProgram(SAW_NDT_APP, path("3.map") + path("2.map") + path("3.map")).exit_code, 0);
    ASSERT_EQ(runAppProgram(SAW_NDT_APP, path("merged.map") + path("3.map") + path("1.map")).exit_code, 0);
    EXPECT_TRUE(bytesOf("merged.map") == bytesOf("whole.map"));
  }
}

TEST_F(MapMergeApp, DrivesAreAddedInPlace) {
  build("whole.map", "-scans 0:6");
  for (const std::string shard : {"1/3", "2/3", "3/3"}) build(shard.substr(0, 1) + ".map", "-shard " + shard);
  AppResult result = runAppProgram(SAW_NDT_APP, "-update " + path("1.map") + path("3.map") + path("2.map"));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("1.map: "), std::string::npos) << result.output;
  EXPECT_NE(result.output.find(" of 6 scans; "), std::string::npos) << result.output;
  const std::string dead = std::to_string(deadBytesOfMapFile((folder.path() / "1.map").string()));
  EXPECT_NE(dead, "0");
  EXPECT_NE(result.output.find("\n" + dead + " of its " + std::to_string(bytesOf("1.map").size()) + " bytes are dead"),
            std::string::npos)
      << result.output;
  result = runAppProgram(SAW_NDT_APP, path("merged.map") + path("1.map"));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("left out: " + dead + " dead bytes"), std::string::npos) << result.output;
  EXPECT_TRUE(bytesOf("merged.map") == bytesOf("whole.map"));
  expectFails(SAW_NDT_APP, "-update " + path("none.map") + path("2.map"), 1, {"none.map: No such file"});
  expectFails(SAW_NDT_APP, "-update " + path("1.map") + path("1.map"), 1, {"1.map: is given twice"});
}

TEST_F(MapMergeApp, ShardsThatAreNoneAreWrongUsage) {
  const std::string build_arguments = quoted(drive_folder) + path("a.map") + kSensor;
  for (const std::string shard : {"0/3", "4/3", "1", "1/", "/3", "1/3/1", "-1/3", "1/0", "a/b", "1 /3"}) {
    expectFails(SAW_NDT_BUILD_MAP_APP, build_arguments + "-shard '" + shard + "'", 2, {"shard '" + shard + "'", "I/N"});
  }
  expectFails(SAW_NDT_BUILD_MAP_APP, build_arguments + "-scans 0:2 -shard 3/4", 2, {"shard '3/4'", "none of 2 scans"});
}

TEST_F(MapMergeApp, FailuresNameTheFilesAndLeaveAnOldMapAlone) {
  build("a.map", "-scans 0:2 -sensor VLP-16");
  build("fine.map", "-scans 2:4 -sensor VLP-16 -resolution 0.25");
  build("flat.map", "-scans 2:4 -sensor VLP-16 -slope-deg 3");
  build("classical.map", "-scans 2:4 -classical");
  folder.write("old.map", "an old map");
  const std::string merge_into_old = path("old.map") + path("a.map");
  expectFails(SAW_NDT_APP, merge_into_old + path("fine.map"), 1, {"fine.map", "a.map", "resolution_m = 0.25", "0.5"});
  expectFails(SAW_NDT_APP, merge_into_old + path("flat.map"), 1, {"flat.map", "a.map", "ground.slope_deg", " 3 "});
  expectFails(SAW_NDT_APP, merge_into_old + path("classical.map"), 1, {"classical.map", "a.map", "labelled"});
  expectFails(SAW_NDT_APP, merge_into_old + path("a.map"), 1, {"a.map: is given twice"});
  expectFails(SAW_NDT_APP, merge_into_old + path("drive/../a.map"), 1, {"a.map: is given twice"});
  expectFails(SAW_NDT_APP, merge_into_old + path("none.map"), 1, {"none.map: No such file"});
  expectFails(SAW_NDT_APP, merge_into_old + path("old.map"), 1, {"old.map: offset 0: not a saw_ndt map"});
  expectFails(SAW_NDT_APP, path("no/out.map") + path("a.map"), 1, {"out.map: No such file"});
  expectFails(SAW_NDT_APP, path("old.map"), 2, {"missing MAP"});
}

}  // namespace
}  // namespace saw_ndt
