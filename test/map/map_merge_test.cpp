#include "saw_ndt/map/map_merge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <optional>
#include <vector>

#include "expect_throws.h"
#include "map_fixtures.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/version.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

class MapMerge : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }
  std::string saved(const std::string& name, const WeightedVoxelMap& map) const {
    map.save(path(name));
    return path(name);
  }
  std::string bytesOf(const WeightedVoxelMap& map) const { return contentOf(saved("bytes.map", map)); }

  /// A map of so many scans, without a segmentation or with one.
  static WeightedVoxelMap mapOfScans(std::initializer_list<unsigned> scans,
                                     const std::optional<SegmentationOptions>& segmentation = std::nullopt,
                                     double resolution_m = 0.8) {
    WeightedMapBuilder builder(resolution_m, segmentation);
    for (const unsigned scan : scans) addCloud(builder, mixedCloud(scan, 2000), Eigen::Isometry3d::Identity());
    return builder.build();
  }

  TemporaryFolder folder;
};

TEST_F(MapMerge, GivesTheBytesOfTheMapOfAllScansInAnyOrderOfFiles) {
  const SegmentationOptions segmentation;
  const std::string expected = bytesOf(mapOfScans({0, 1, 2, 3, 4, 5, 6}, segmentation));
  std::vector<std::string> paths = {
      saved("a.map", mapOfScans({0, 3, 6}, segmentation)), saved("b.map", mapOfScans({4, 1}, segmentation)),
      saved("c.map", mapOfScans({5, 2}, segmentation)), saved("d.map", mapOfScans({}, segmentation))};
  std::sort(paths.begin(), paths.end());
  do {
    EXPECT_TRUE(bytesOf(mergeMapFiles(paths)) == expected);
    const WrittenMap written = mergeMapFiles(paths, path("merged.map"), 2);
    EXPECT_TRUE(contentOf(path("merged.map")) == expected);
    EXPECT_EQ(written.file_bytes, expected.size());
  } while (std::next_permutation(paths.begin(), paths.end()));
  EXPECT_TRUE(bytesOf(mergeMapFiles({path("a.map")})) == contentOf(path("a.map")));
}

TEST_F(MapMerge, WritesTheFileOfManyTilesThatTheBuilderMakes) {
  WeightedMapBuilder builder(0.4);
  std::vector<std::string> paths;
  for (unsigned drive = 0; drive < 4; ++drive) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() << 45.0 * drive, -30.0 * drive, 4.0 * drive;
    WeightedMapBuilder part(0.4);
    for (unsigned scan = 0; scan < 2; ++scan) {
      addCloud(builder, mixedCloud(2 * drive + scan, 3000, 60.0F), T);
      addCloud(part, mixedCloud(2 * drive + scan, 3000, 60.0F), T);
    }
    paths.push_back(saved(std::to_string(drive) + ".map", part.build()));
  }
  const WeightedVoxelMap whole = builder.build();
  const std::string expected = bytesOf(whole);
  for (const int threads : {1, 2, 0}) {
    const WrittenMap written = mergeMapFiles(paths, path("merged.map"), threads);
    EXPECT_TRUE(contentOf(path("merged.map")) == expected);
    EXPECT_EQ(written.origin.point_count, whole.origin().point_count);
    EXPECT_EQ(written.origin.scan_count, 8U);
    EXPECT_EQ(written.entry_count, whole.entries().size());
    EXPECT_EQ(written.voxel_count, whole.voxelCount());
    EXPECT_GT(written.tile_count, 60U);
    std::rotate(paths.begin(), paths.begin() + 1, paths.end());
  }
  // Into one of the files.
  mergeMapFiles(paths, paths[1]);
  EXPECT_TRUE(contentOf(paths[1]) == expected);
}

TEST_F(MapMerge, FailsWithoutATrace) {
  const std::string a = saved("a.map", mapOfScans({0})), b = saved("b.map", mapOfScans({1}));
  std::string damaged = contentOf(b);
  damaged[damaged.size() - 3] = static_cast<char>(damaged[damaged.size() - 3] ^ 4);
  folder.write("damaged.map", damaged);
  const std::size_t files = folder.entryCount();
  expectThrows<Error>([&] { mergeMapFiles({a, path("damaged.map")}, path("out.map")); }, {"damaged.map: offset "});
  expectThrows<Error>([&] { mergeMapFiles({a, path("none.map")}, path("out.map")); }, {"none.map: No such file"});
  expectThrows<Error>([&] { mergeMapFiles({a, b}, path("no/out.map")); }, {"out.map: No such file"});
  expectThrows<std::invalid_argument>([&] { mergeMapFiles({}, path("out.map")); }, {"no map"});
  // The tiles are whole, but the header tells another number of points.
  MapOrigin origin = mapOfScans({1}).origin();
  ++origin.point_count;
  const std::string wrong = saved("wrong.map", {origin, mapOfScans({1}).entries()});
  expectThrows<Error>([&] { mergeMapFiles({a, wrong}, path("out.map")); }, {"wrong.map: offset ", "number of points"});
  EXPECT_EQ(folder.entryCount(), files + 1);
}

TEST_F(MapMerge, MapsOfDifferentOriginsDoNotMerge) {
  const auto at = [&](const std::string& name, double easting_m) {
    WeightedMapBuilder builder(0.8);
    builder.setMapOrigin({easting_m, 5.25, 0.0});
    addCloud(builder, mixedCloud(1, 500), Eigen::Isometry3d::Identity());
    return saved(name, builder.build());
  };
  const std::string a = at("a.map", 1000.0), b = at("b.map", 1000.0), c = at("c.map", 2000.0);
  const std::string local = saved("local.map", mapOfScans({1})), empty = saved("empty.map", mapOfScans({}));
  EXPECT_EQ(mergeMapFiles({empty, a, b}).origin().map_origin_m, Eigen::Vector3d(1000.0, 5.25, 0.0));
  EXPECT_TRUE(bytesOf(mergeMapFiles({empty, a, b})) == bytesOf(mergeMapFiles({a, b, empty})));
  expectThrows<Error>(
      [&] {
        mergeMapFiles({a, c});
      },
      {"c.map: does not merge with ", "a.map: ", "map_origin_m = 2000 5.25 0", "1000 5.25 0"});
  expectThrows<Error>([&] { mergeMapFiles({a, local}); }, {"local.map: does not", "map_origin_m = 0 0 0"});
  expectThrows<Error>([&] { mergeMapFiles({local, a}); }, {"a.map: does not merge", "map_origin_m"});
  WeightedMapBuilder builder(0.8);
  builder.setMapOrigin({2000.0, 5.25, 0.0});
  expectThrows<std::invalid_argument>([&] { builder.merge(WeightedVoxelMap::load(a)); }, {"map_origin_m"});
}

TEST_F(MapMerge, NamesTheFilesAndWhatDiffers) {
  SegmentationOptions segmentation;
  const std::string a = saved("a.map", mapOfScans({0}, segmentation));
  const std::string fine = saved("fine.map", mapOfScans({1}, segmentation, 0.4));
  const std::string unknown = saved("unknown.map", mapOfScans({1}));
  const std::string plain = saved("plain.map", mapOf(withoutLabels(mixedCloud(1, 100)), 0.8));
  segmentation.ground.slope_deg = 9.25;
  const std::string flat = saved("flat.map", mapOfScans({1}, segmentation));
  expectThrows<Error>([&] { mergeMapFiles({a, fine}); }, {"fine.map: does not merge with ", "a.map", "0.4", "0.8"});
  expectThrows<Error>([&] { mergeMapFiles({a, flat}); }, {"flat.map", "a.map", "ground.slope_deg", " 10 ", " 9.25 "});
  expectThrows<Error>([&] { mergeMapFiles({a, unknown}); }, {"unknown.map", "a.map", "segmentation", "known"});
  expectThrows<Error>([&] { mergeMapFiles({a, plain}); }, {"plain.map", "a.map", "labelled or unlabelled"});
  expectThrows<Error>([&] { mergeMapFiles({plain, unknown}); }, {"unknown.map", "plain.map", "labelled or unlabelled"});
  expectThrows<Error>([&] { mergeMapFiles({a, path("none.map")}); }, {"none.map: No such file"});
  expectThrows<Error>([&] { mergeMapFiles({a, folder.write("b.map", "a map").string()}); }, {"b.map: offset 0"});
  expectThrows<std::invalid_argument>([&] { mergeMapFiles({}); }, {"no map"});
}

TEST_F(MapMerge, AFileGivenTwiceIsAnErrorUnderWhateverName) {
  const std::string a = saved("a.map", mapOfScans({0}));
  const std::string b = saved("b.map", mapOfScans({1}));
  expectThrows<Error>([&] { mergeMapFiles({a, b, a}); }, {"a.map: is given twice"});
  std::filesystem::create_symlink("a.map", path("link.map"));
  expectThrows<Error>(
      [&] {
        mergeMapFiles({a, b, path("link.map")});
      },
      {"link.map: is given twice, also as ", "a.map"});
  expectThrows<Error>([&] { mergeMapFiles({a, path("./a.map")}); }, {"is given twice"});
}

// A map of one voxel with one point or so many, met by so many scans.
WeightedVoxelMap oneVoxel(std::uint64_t point_count, std::uint32_t scan_count_of_voxel, std::uint64_t scan_count,
                          const std::string& version = SAW_NDT_VERSION) {
  LabelledVoxelSums entry;
  entry.voxel = VoxelCoordinate::Zero();
  entry.sums.count = point_count;
  entry.scan_count = scan_count_of_voxel;
  MapOrigin origin;
  origin.labelled = true;
  origin.scan_count = scan_count;
  origin.point_count = point_count;
  origin.software_version = version;
  return {origin, {entry}};
}

WeightedVoxelMap merged(const std::vector<WeightedVoxelMap>& maps) {
  WeightedMapBuilder builder(1.0);
  for (const WeightedVoxelMap& map : maps) builder.merge(map);
  return builder.build();
}

TEST_F(MapMerge, ScansOfAVoxelThatAreNotKnownOfAPartAreNotKnownOfTheWhole) {
  std::vector<WeightedVoxelMap> maps = {oneVoxel(5, 2, 9), oneVoxel(6, 0, 9), oneVoxel(7, 4, 9)};
  for (int turn = 0; turn < 3; ++turn) {
    const WeightedVoxelMap map = merged(maps);
    EXPECT_EQ(map.entries().front().scan_count, 0U);
    EXPECT_EQ(map.entries().front().sums.count, 18U);
    EXPECT_EQ(map.origin().scan_count, 27U);
    std::rotate(maps.begin(), maps.begin() + 1, maps.end());
  }
  EXPECT_EQ(merged({maps[0], maps[2]}).entries().front().scan_count, 6U);
  WeightedMapBuilder builder(1.0);
  builder.merge(maps[1]);
  pcl::PointCloud<pcl::PointXYZL> cloud;
  cloud.push_back({0.5F, 0.5F, 0.5F, 2U});
  addCloud(builder, cloud, Eigen::Isometry3d::Identity());
  EXPECT_EQ(builder.build().entries().front().scan_count, 0U);
}

TEST_F(MapMerge, WhatThereIsNoRoomForIsRefusedOrToldAsTheMost) {
  constexpr std::uint32_t kMostScans = (1U << 24U) - 1;
  EXPECT_EQ(merged({oneVoxel(9, kMostScans, kMostScans), oneVoxel(9, 5, 5)}).entries().front().scan_count, kMostScans);
  constexpr std::uint64_t kMost = VoxelSums::kMostPoints;
  EXPECT_EQ(merged({oneVoxel(kMost - 1, 1, 1), oneVoxel(1, 1, 1)}).origin().point_count, kMost);
  WeightedMapBuilder builder(1.0);
  builder.merge(oneVoxel(kMost, 1, 1));
  expectThrows<std::invalid_argument>([&] { builder.merge(oneVoxel(1, 1, 1)); }, {"2^33 points"});
  constexpr std::uint64_t kMostMapScans = std::numeric_limits<std::uint64_t>::max();
  expectThrows<std::invalid_argument>([&] { builder.merge(oneVoxel(1, 1, kMostMapScans)); }, {"scan_count"});
  EXPECT_EQ(builder.origin().scan_count, 1U);
  EXPECT_EQ(builder.origin().point_count, kMost);
  const std::string full = saved("full.map", oneVoxel(kMost, 1, 1)), one = saved("one.map", oneVoxel(1, 1, 1));
  expectThrows<Error>(
      [&] {
        mergeMapFiles({full, one});
      },
      {"one.map: does not merge with ", "full.map: ", "2^33 points"});
  const std::string more = saved("more.map", oneVoxel(1, 1, kMostMapScans));
  expectThrows<Error>(
      [&] {
        mergeMapFiles({one, more});
      },
      {"more.map: does not merge with ", "one.map: ", "scan_count"});
}

TEST_F(MapMerge, TellsTheSoftwareVersionWhereItIsOne) {
  const WeightedVoxelMap a = oneVoxel(1, 1, 1, "0.0.1"), b = oneVoxel(2, 1, 1, "0.0.2");
  EXPECT_EQ(merged({a, a}).origin().software_version, "0.0.1");
  EXPECT_EQ(merged({a, b, a}).origin().software_version, "");
  EXPECT_EQ(merged({b, a, a}).origin().software_version, "");
  WeightedMapBuilder builder(1.0);
  builder.merge(a);
  addCloud(builder, mixedCloud(1, 50), Eigen::Isometry3d::Identity());
  EXPECT_EQ(builder.origin().software_version, "");
}

}  // namespace
}  // namespace saw_ndt
