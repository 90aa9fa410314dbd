#include "drive_files.h"
#include "map/passing_car.h"
#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt {
namespace {

class MapRemoveMovedApp : public DriveFiles {
 protected:
  MapRemoveMovedApp() {
    std::filesystem::remove_all(drive_folder);
    writeKittiDrive(drive_folder, driveAmongTraffic(SensorModel::named("VLP-16"), 30));
  }

  std::string path(const std::string& name) const { return quoted(folder.path() / name); }
  std::string bytesOf(const std::string& name) const { return contentOf(folder.path() / name); }
  void build(const std::string& name, const std::string& more) const {
    const AppResult result = runAppProgram(SAW_NDT_BUILD_MAP_APP, quoted(drive_folder) + path(name) + more);
    ASSERT_EQ(result.exit_code, 0) << result.errors;
  }
  AppResult remove(const std::string& arguments) const { return runAppProgram(SAW_NDT_APP, arguments); }
};

TEST_F(MapRemoveMovedApp, GivesTheBytesThatBuildingWithTheOptionGives) {
  build("whole.map", "-sensor VLP-16");
  build("expected.map", "-sensor VLP-16 -remove-moved");
  EXPECT_LT(bytesOf("expected.map").size(), bytesOf("whole.map").size());
  const WeightedVoxelMap whole = WeightedVoxelMap::load(folder.path() / "whole.map");
  const WeightedVoxelMap expected = WeightedVoxelMap::load(folder.path() / "expected.map");
  EXPECT_EQ(expected.origin().scan_count, 30U);
  EXPECT_GT(whole.origin().point_count, expected.origin().point_count + 300);

  const AppResult result = remove(path("whole.map") + path("out.map") + quoted(drive_folder) + "-threads 3");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.errors, "");
  const std::uint64_t removed = whole.origin().point_count - expected.origin().point_count;
  EXPECT_NE(result.output.find(std::to_string(removed) + " of " + std::to_string(whole.origin().point_count)),
            std::string::npos)
      << result.output;
  EXPECT_TRUE(bytesOf("out.map") == bytesOf("expected.map"));

  // Of a map merged from shards, in place, whatever the order and the threads.
  for (const std::string shard : {"1/2", "2/2"}) {
    build(shard.substr(0, 1) + ".map", "-sensor VLP-16 -shard " + shard);
  }
  ASSERT_EQ(runAppProgram(SAW_NDT_MAP_MERGE_APP, path("out.map") + path("1.map") + path("2.map")).exit_code, 0);
  ASSERT_EQ(remove(path("out.map") + path("out.map") + quoted(drive_folder) + "-threads 1 -scans ::-1").exit_code, 0);
  EXPECT_TRUE(bytesOf("out.map") == bytesOf("expected.map"));
}

TEST_F(MapRemoveMovedApp, AnotherThresholdIsGivenAlike) {
  build("whole.map", "-classical");
  build("expected.map", "-classical -remove-moved -max-hit-share 0.05");
  build("default.map", "-classical -remove-moved");
  ASSERT_EQ(remove(path("whole.map") + path("out.map") + quoted(drive_folder) + "-max-hit-share 0.05").exit_code, 0);
  EXPECT_TRUE(bytesOf("out.map") == bytesOf("expected.map"));
  EXPECT_LT(bytesOf("default.map").size(), bytesOf("out.map").size());
}

TEST_F(MapRemoveMovedApp, AScanThatCannotBeReadIsLeftOut) {
  build("whole.map", "-sensor VLP-16 -scans 1:");
  build("expected.map", "-sensor VLP-16 -scans 1: -remove-moved");
  replace("velodyne/000000.bin", "");
  const std::string arguments = path("whole.map") + path("out.map") + quoted(drive_folder);
  const AppResult result = remove(arguments);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.errors.find("000000.bin: offset 0: the file is empty: left out\n"), std::string::npos);
  EXPECT_NE(result.output.find("1 scans left out"), std::string::npos) << result.output;
  EXPECT_TRUE(bytesOf("out.map") == bytesOf("expected.map"));
  expectFails(SAW_NDT_APP, arguments + "-strict", 1, {"000000.bin: offset 0: the file is empty"});
  // The same within the build, where it is told once.
  const AppResult built =
      runAppProgram(SAW_NDT_BUILD_MAP_APP, quoted(drive_folder) + path("out.map") + "-sensor VLP-16 -remove-moved");
  ASSERT_EQ(built.exit_code, 0) << built.errors;
  EXPECT_EQ(built.errors.find("left out"), built.errors.rfind("left out"));
}

TEST_F(MapRemoveMovedApp, WrongUsageAndFailuresAreNamed) {
  build("a.map", "-sensor VLP-16 -scans 0:3");
  folder.write("old.map", "an old map");
  const std::string drive = quoted(drive_folder);
  expectFails(SAW_NDT_APP, path("a.map") + path("out.map"), 2, {"missing SEQUENCE"});
  expectFails(SAW_NDT_APP, path("a.map") + path("out.map") + drive + "-max-hit-share 0", 2, {"max_hit_share = 0"});
  expectFails(SAW_NDT_APP, path("a.map") + path("out.map") + drive + "-max-hit-share 0.6", 2, {"max_hit_share = 0.6"});
  expectFails(SAW_NDT_APP, path("a.map") + path("out.map") + drive + drive + "-poses p.txt", 2, {"-poses"});
  expectFails(SAW_NDT_APP, path("a.map") + path("out.map") + drive + "-scans 40:", 2, {"scan selection '40:'"});
  expectFails(SAW_NDT_APP, path("none.map") + path("out.map") + drive, 1, {"none.map: No such file"});
  expectFails(SAW_NDT_APP, path("old.map") + path("out.map") + drive, 1, {"old.map: offset 0: not a saw_ndt map"});
  expectFails(SAW_NDT_APP, path("a.map") + path("no/out.map") + drive, 1, {"out.map: No such file"});
  expectFails(SAW_NDT_APP, path("a.map") + path("old.map") + path("nowhere"), 1, {"nowhere: No such file"});
  const std::string building = drive + path("out.map") + "-sensor VLP-16 ";
  expectFails(SAW_NDT_BUILD_MAP_APP, building + "-remove-moved -shard 1/2", 2, {"-shard", "saw_ndt_map_remove_moved"});
  expectFails(SAW_NDT_BUILD_MAP_APP, building + "-max-hit-share 0.2", 2, {"-max-hit-share goes with -remove-moved"});
  expectFails(SAW_NDT_BUILD_MAP_APP, building + "-remove-moved -max-hit-share 2", 2, {"max_hit_share = 2"});
}

}  // namespace
}  // namespace saw_ndt
