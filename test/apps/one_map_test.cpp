#include <algorithm>
#include <numeric>
#include <random>

#include "drive_files.h"
#include "drives/drive_plan.h"
#include "saw_ndt/drives/recording.h"
#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt {
namespace {

// The map of the same scans has the same bytes, however the work was shared.
class OneMap : public DriveFiles {
 protected:
  OneMap() { writeKittiDrive(other_folder, driveDownTheStreet(SensorModel::named("VLP-16"), 9)); }

  std::string file(const std::string& name) const { return quoted(folder.path() / name); }

  // The bytes of a map of both drives.
  std::string built(const std::string& name, const std::string& more) const {
    const AppResult result = runAppProgram(
        SAW_NDT_BUILD_MAP_APP, quoted(drive_folder) + quoted(other_folder) + file(name) + "-sensor VLP-16 " + more);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return contentOf(folder.path() / name);
  }

  const std::filesystem::path other_folder = folder.path() / "other";
};

TEST_F(OneMap, WithAnyNumberOfThreads) {
  const std::string expected = built("1.map", "-threads 1");
  EXPECT_EQ(WeightedVoxelMap::load(folder.path() / "1.map").origin().scan_count, 15U);
  EXPECT_TRUE(built("2.map", "-threads 2") == expected);
  EXPECT_TRUE(built("4.map", "-threads 4") == expected);
}

TEST_F(OneMap, OfScansInAnyOrder) {
  built("a.map", "-threads 1");
  const std::unique_ptr<Recording> recordings[] = {openRecording(drive_folder), openRecording(other_folder)};
  DriveMapOptions common;
  std::vector<internal::DrivePlan> plans(2);
  const WeightedVoxelMap expected = WeightedVoxelMap::load(folder.path() / "a.map");
  std::mt19937 random(1);
  for (int trial = 0; trial < 3; ++trial) {
    for (std::size_t i = 0; i < plans.size(); ++i) {
      plans[i].segmentation = expected.origin().segmentation;
      plans[i].scans.resize(static_cast<std::size_t>(recordings[i]->scanCount()));
      std::iota(plans[i].scans.begin(), plans[i].scans.end(), 0);
      std::shuffle(plans[i].scans.begin(), plans[i].scans.end(), random);
    }
    const auto open = [&](int drive) -> const Recording& { return *recordings[drive]; };
    internal::buildMapOfDrives(plans, open, common, folder.path(), {}).save((folder.path() / "shuffled.map").string());
    EXPECT_TRUE(contentOf(folder.path() / "shuffled.map") == contentOf(folder.path() / "a.map"));
  }
}

TEST_F(OneMap, OfShardsThatAreMerged) {
  const std::string expected = built("whole.map", "");
  for (const std::string shard : {"1", "2", "3"}) {
    built(shard + ".map", "-shard " + shard + "/3");
    EXPECT_EQ(WeightedVoxelMap::load(folder.path() / (shard + ".map")).origin().scan_count, 5U);
  }
  const AppResult merged =
      runAppProgram(SAW_NDT_MAP_MERGE_APP, file("merged.map") + file("3.map") + file("1.map") + file("2.map"));
  ASSERT_EQ(merged.exit_code, 0) << merged.errors;
  EXPECT_TRUE(contentOf(folder.path() / "merged.map") == expected);
}

TEST_F(OneMap, OfDrivesThatAreMerged) {
  const std::string expected = built("whole.map", "-mounting stated");
  for (const auto& [name, drive] : {std::pair("1.map", drive_folder), std::pair("2.map", other_folder)}) {
    const AppResult result =
        runAppProgram(SAW_NDT_BUILD_MAP_APP, quoted(drive) + file(name) + "-sensor VLP-16 -mounting stated");
    ASSERT_EQ(result.exit_code, 0) << result.errors;
  }
  const AppResult merged = runAppProgram(SAW_NDT_MAP_MERGE_APP, file("merged.map") + file("1.map") + file("2.map"));
  ASSERT_EQ(merged.exit_code, 0) << merged.errors;
  EXPECT_TRUE(contentOf(folder.path() / "merged.map") == expected);
}

TEST_F(OneMap, DrivesHavePosesOfTheirOwnAndOneSensor) {
  const std::string expected = built("a.map", "");
  const std::string both = quoted(drive_folder) + quoted(other_folder);
  std::filesystem::rename(drive_folder / "poses.txt", folder.path() / "1.txt");
  std::filesystem::rename(other_folder / "poses.txt", folder.path() / "2.txt");
  const std::string poses = (folder.path() / "1.txt").string() + "," + (folder.path() / "2.txt").string();
  EXPECT_TRUE(built("a.map", "-poses '" + poses + "'") == expected);
  std::filesystem::remove(folder.path() / "a.map");
  expectFails(SAW_NDT_BUILD_MAP_APP, both + file("a.map") + "-poses " + file("1.txt"), 2,
              {"-poses", "has 1 files, where there are 2 recordings"});
  expectFails(SAW_NDT_BUILD_MAP_APP, both + file("a.map") + "-shard 16/16 -poses '" + poses + "'", 2,
              {"shard '16/16'", "none of 15 scans"});
  writeKittiDrive(folder.path() / "fine", driveDownTheStreet(SensorModel::named("HDL-64E"), 2));
  std::filesystem::rename(folder.path() / "1.txt", drive_folder / "poses.txt");
  const AppResult result = runAppProgram(SAW_NDT_BUILD_MAP_APP, quoted(drive_folder) + file("fine") + file("a.map"));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.errors.find("fine: does not go into one map with "), std::string::npos) << result.errors;
  EXPECT_NE(result.errors.find("sensor."), std::string::npos) << result.errors;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.map"));
}

}  // namespace
}  // namespace saw_ndt
