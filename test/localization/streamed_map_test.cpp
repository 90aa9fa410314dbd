#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <thread>
#include <vector>

#include "localization/scans_in_memory.h"
#include "localization/simulated_scans.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/localization/localizer.h"
#include "saw_ndt/localization/map_pack.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

/// A map of some hundred metres of road and another drive along it.
class StreamedMap : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new TemporaryFolder();
    ScansInMemory scans(simulatedScans("residential", 1, 0, 200, 8));
    const std::string statistics_file = (folder->path() / "statistics.map").string();
    buildDriveMap(scans, {}).build().save(statistics_file);
    packMap(statistics_file, mapFile(), LocalizationMethod::named("weighted").voxels);
    drive = new SyntheticDrive(simulatedScans("residential", 2, 0, 150, 6));
  }
  static void TearDownTestSuite() {
    delete drive;
    delete folder;
  }

  // Short, so that sets of tiles are small.
  static constexpr double kRadius_m = 40.0;

  static std::string mapFile() { return (folder->path() / "packed.map").string(); }
  static LocalizerOptions options() {
    LocalizerOptions options;
    options.tiles.radius_m = kRadius_m;
    options.tiles.hysteresis_m = 10.0;
    return options;
  }
  static std::vector<LocalizationResult> follow(Localizer& localizer, std::size_t most_scans = 1000) {
    std::vector<LocalizationResult> results;
    for (std::size_t i = 0; i < std::min(most_scans, drive->scans.size()); ++i) {
      results.push_back(localizer.localize(viewOf(drive->scans[i]), drive->stamps_s[i]));
    }
    return results;
  }

  static TemporaryFolder* folder;
  static SyntheticDrive* drive;
};

TemporaryFolder* StreamedMap::folder = nullptr;
SyntheticDrive* StreamedMap::drive = nullptr;

TEST_F(StreamedMap, GivesTheSameBitsAsTheWholeMap) {
  LocalizerOptions all_at_once = options();
  all_at_once.tiles.hysteresis_m = 1e4;
  Localizer whole(mapFile(), all_at_once), streamed(mapFile(), options());
  whole.setInitialPose(drive->T_map_lidar.front());
  streamed.setInitialPose(drive->T_map_lidar.front());
  const std::vector<LocalizationResult> expected = follow(whole), results = follow(streamed);
  for (std::size_t i = 0; i < results.size(); ++i) {
    SCOPED_TRACE(i);
    EXPECT_EQ(results[i].acceptance, expected[i].acceptance);
    EXPECT_EQ(results[i].T_map_base.matrix(), expected[i].T_map_base.matrix());
    EXPECT_EQ(results[i].covariance, expected[i].covariance);
    EXPECT_LT((results[i].T_map_base.translation() - drive->T_map_lidar[i].translation()).norm(), 0.05);
  }
  const double way_m = (drive->T_map_lidar.back().translation() - drive->T_map_lidar.front().translation()).norm();
  ASSERT_GT(way_m, 60.0) << "tiles are to change on the way";
  ASSERT_NE(streamed.tileLoads(), nullptr);
  EXPECT_GE(streamed.tileLoads()->loads, 3U);
  EXPECT_EQ(streamed.tileLoads()->least_radius_m, 0.0);
  EXPECT_EQ(whole.tileLoads()->loads, 1U);
}

// Each has tiles of its own, and all the same file.
TEST_F(StreamedMap, ServesLocalizersSideBySide) {
  const LocalizationMap map(mapFile());
  std::vector<std::vector<LocalizationResult>> results(3);
  std::vector<std::thread> threads;
  for (std::vector<LocalizationResult>& of_thread : results) {
    threads.emplace_back([&of_thread, map] {
      LocalizerOptions with = options();
      with.alignment.threads = 1;
      Localizer localizer(TiledTarget(map, with.tiles), with);
      localizer.setInitialPose(drive->T_map_lidar.front());
      of_thread = follow(localizer, 8);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < results[0].size(); ++i) {
    EXPECT_EQ(results[1][i].T_map_base.matrix(), results[0][i].T_map_base.matrix());
    EXPECT_EQ(results[2][i].T_map_base.matrix(), results[0][i].T_map_base.matrix());
  }
}

TEST_F(StreamedMap, IsSearchedWhereTheStartIsUnknown) {
  Localizer streamed(mapFile(), options());
  streamed.setUnknownPose();
  const std::vector<LocalizationResult> results = follow(streamed);
  std::size_t accepted = 0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (!results[i].accepted()) continue;
    EXPECT_EQ(results[i].search == SearchExtent::EVERYWHERE, accepted == 0);
    ++accepted;
    EXPECT_LT((results[i].T_map_base.translation() - drive->T_map_lidar[i].translation()).norm(), 0.05) << i;
  }
  EXPECT_GE(accepted, results.size() - 5);
}

TEST_F(StreamedMap, HasFewerTilesWhereMemoryIsBound) {
  LocalizerOptions bound = options();
  bound.tiles.most_bytes = 1;
  Localizer streamed(mapFile(), bound);
  streamed.setInitialPose(drive->T_map_lidar.front());
  const LocalizationResult result = streamed.localize(viewOf(drive->scans.front()), drive->stamps_s.front());
  EXPECT_GT(streamed.tileLoads()->least_radius_m, 0.0);
  EXPECT_LT(streamed.tileLoads()->least_radius_m, kRadius_m);
  EXPECT_TRUE(result.T_map_base.matrix().allFinite());
}

// Points that lie farther away than tiles reach would meet voxels or not, by which set of tiles is there.
TEST_F(StreamedMap, TakesPointsAsFarAsTilesReach) {
  ScanPreparationOptions all, near;
  near.max_reach_m = 15.0;
  for (ScanPreparationOptions* with : {&all, &near}) {
    with->motion_compensation = MotionCompensation::FROM_AZIMUTH_CLOCKWISE;
  }
  ScanPreparation prepare_all(all), prepare_near(near);
  const SourcePoints& expected = prepare_all.prepare(viewOf(drive->scans.front()));
  const SourcePoints& found = prepare_near.prepare(viewOf(drive->scans.front()));
  std::size_t next = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (std::hypot(expected.x[i], expected.y[i]) > 15.0F) continue;
    ASSERT_LT(next, found.size());
    ASSERT_EQ(found.x[next], expected.x[i]);
    ASSERT_EQ(found.z[next], expected.z[i]);
    ASSERT_EQ(found.label[next], expected.label[i]);
    ASSERT_EQ(prepare_near.times_s()[next], prepare_all.times_s()[i]);
    ++next;
  }
  EXPECT_EQ(found.size(), next);
  EXPECT_GT(next, 1000U);
  EXPECT_LT(next, expected.size());
  near.max_reach_m = 0.0;
  EXPECT_THROW(near.check(), std::invalid_argument);
}

TEST_F(StreamedMap, OptionsThatDoNotHoldAreNamed) {
  for (double TiledTargetOptions::*const option :
       {&TiledTargetOptions::radius_m, &TiledTargetOptions::hysteresis_m, &TiledTargetOptions::lookahead_s}) {
    TiledTargetOptions bad;
    bad.*option = 0.0;
    EXPECT_THROW(bad.check(), std::invalid_argument);
    bad.*option = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(bad.check(), std::invalid_argument);
  }
}

}  // namespace
}  // namespace saw_ndt
