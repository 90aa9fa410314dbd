#include "saw_ndt/map/map_crop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "expect_throws.h"
#include "map_fixtures.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/map/weighted_map_builder.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Voxels of 0.5 m with centres from -4.75 to 4.75 m along x and y and -0.75 to 0.75 m along z: 20 x 20 x 4, two labels
// and three points each.
WeightedVoxelMap slab() {
  MapOrigin origin;
  origin.resolution_m = 0.5;
  origin.labelled = true;
  origin.scan_count = 7;
  std::vector<LabelledVoxelSums> entries;
  for (int x = -10; x < 10; ++x) {
    for (int y = -10; y < 10; ++y) {
      for (int z = -2; z < 2; ++z) {
        LabelledVoxelSums entry;
        entry.voxel << x, y, z;
        entry.scan_count = 2;
        entry.sums.count = 2;
        entry.sums.sum = {x, y, z};
        entry.label = StructuralLabel::GROUND;
        entries.push_back(entry);
        entry.sums.count = 1;
        entry.label = StructuralLabel::NON_GROUND;
        entries.push_back(entry);
        origin.point_count += 3;
      }
    }
  }
  return {origin, entries};
}

/// How many voxels a region keeps of the slab.
std::size_t voxelsIn(const MapRegion& region) {
  const WeightedVoxelMap map = cropMap(slab(), region);
  EXPECT_EQ(map.origin().point_count, 3 * map.entries().size() / 2);
  EXPECT_EQ(map.origin().scan_count, 7U);
  return map.entries().size() / 2;
}

TEST(MapCrop, KeepsWholeVoxelsWithUnchangedSums) {
  const WeightedVoxelMap map = slab();
  const WeightedVoxelMap cropped = cropMap(map, [](const Eigen::Vector3d& centre_m) {
    EXPECT_EQ(std::abs(std::remainder(centre_m.x(), 0.5)), 0.25);
    return centre_m == Eigen::Vector3d(1.25, -4.75, 0.25);
  });
  ASSERT_EQ(cropped.entries().size(), 2U);
  EXPECT_EQ(cropped.entries()[0].voxel, VoxelCoordinate(2, -10, 0));
  EXPECT_EQ(cropped.entries()[0].sums.count, 2U);
  EXPECT_EQ(cropped.entries()[0].sums.sum, (std::array<std::int64_t, 3>{2, -10, 0}));
  EXPECT_EQ(cropped.entries()[0].scan_count, 2U);
  EXPECT_EQ(cropped.entries()[1].label, StructuralLabel::NON_GROUND);
  EXPECT_EQ(cropped.resolution(), map.resolution());
  EXPECT_TRUE(cropped.labelled());
}

TEST(MapCrop, ABoxHoldsItsLeastCornerAndNotItsGreatest) {
  EXPECT_EQ(voxelsIn(boxRegion({-4.75, -kInfinity, -kInfinity}, {4.75, kInfinity, kInfinity})), 19U * 20U * 4U);
  EXPECT_EQ(voxelsIn(boxRegion({0.0, 1.0, -kInfinity}, {1.0, 3.0, kInfinity})), 2U * 4U * 4U);
  EXPECT_EQ(voxelsIn(boxRegion({0.0, 1.0, -0.25}, {1.0, 3.0, 0.5})), 2U * 4U * 2U);
  EXPECT_EQ(voxelsIn(boxRegion({5.0, 5.0, 5.0}, {6.0, 6.0, 6.0})), 0U);
  expectThrows<std::invalid_argument>([] { boxRegion({0, 2, 0}, {1, 2, 1}); }, {"least_m.y = 2"});
  expectThrows<std::invalid_argument>([] { boxRegion({0, 0, 0}, {1, std::nan(""), 1}); }, {"least_m.y"});
}

TEST(MapCrop, APolygonHoldsTheVoxelsWhoseCentresItEncloses) {
  // An L of 3 m^2, whose edges lie between centres; either way round, and closed or not.
  std::vector<Eigen::Vector2d> l = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  EXPECT_EQ(voxelsIn(polygonRegion(l)), 12U * 4U);
  l.push_back(l.front());
  EXPECT_EQ(voxelsIn(polygonRegion(l)), 12U * 4U);
  std::reverse(l.begin(), l.end());
  EXPECT_EQ(voxelsIn(polygonRegion(l)), 12U * 4U);
  // Below a diagonal there are 20 * 19 / 2 of the 20 x 20 columns; those whose centres it crosses belong to one side.
  const std::size_t below = voxelsIn(polygonRegion({{-5, -5}, {5, -5}, {5, 5}}));
  const std::size_t above = voxelsIn(polygonRegion({{-5, -5}, {5, 5}, {-5, 5}}));
  EXPECT_TRUE(below == 190U * 4U || below == 210U * 4U) << below;
  EXPECT_EQ(below + above, 400U * 4U);
  // Vertices and edges on centres: each belongs to one of four squares.
  std::size_t sum = 0;
  for (const double x : {-4.75, 0.25}) {
    for (const double y : {-4.75, 0.25}) {
      sum += voxelsIn(polygonRegion({{x, y}, {x + 5.0, y}, {x + 5.0, y + 5.0}, {x, y + 5.0}}));
    }
  }
  EXPECT_EQ(sum, 400U * 4U);
  expectThrows<std::invalid_argument>([] { polygonRegion({{0, 0}, {1, 1}}); }, {"vertices_m", "3 or more"});
  expectThrows<std::invalid_argument>([] { polygonRegion({{0, 0}, {1, kInfinity}, {1, 0}}); }, {"vertices_m[1]"});
}

TEST(MapCrop, AroundALineIsTheDistanceOfItsEdgesNotOfItsPoints) {
  // y within 0.25 m of 0.5 m: the rows at 0.25 and 0.75 m; the ends reach no further along x than the line.
  EXPECT_EQ(voxelsIn(regionAround({{-10, 0.5}, {10, 0.5}}, 0.25)), 20U * 2U * 4U);
  EXPECT_EQ(voxelsIn(regionAround({{-1, 0.5}, {1, 0.5}}, 0.25)), 4U * 2U * 4U);
  // One point: itself and its four neighbours half a metre away.
  EXPECT_EQ(voxelsIn(regionAround({{0.25, 0.25}}, 0.5)), 5U * 4U);
  EXPECT_EQ(voxelsIn(regionAround({{0.25, 0.25}, {0.25, 0.25}}, 0.49)), 4U);
  expectThrows<std::invalid_argument>([] { regionAround({}, 1.0); }, {"points_m"});
  for (const double radius_m : {0.0, -1.0, std::nan(""), kInfinity}) {
    expectThrows<std::invalid_argument>([&] { regionAround({{0, 0}}, radius_m); }, {"radius_m"});
  }
}

TEST(MapCrop, LongLinesAndPolygonsAreAsEdgeByEdge) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(-6.0, 6.0);
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < 37; ++i) points.emplace_back(anywhere(random), anywhere(random));
  const MapRegion around = regionAround(points, 0.1), polygon = polygonRegion(points);
  int near_count = 0, inside_count = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const Eigen::Vector3d position(anywhere(random), anywhere(random), anywhere(random));
    double distance = kInfinity;
    bool inside = false;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector2d a = points[i], b = points[(i + 1) % points.size()], p = position.head<2>();
      if ((a.y() <= p.y()) != (b.y() <= p.y()) && p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) {
        inside = !inside;
      }
      if (i + 1 == points.size()) continue;
      const double t = std::min(1.0, std::max(0.0, (p - a).dot(b - a) / (b - a).squaredNorm()));
      distance = std::min(distance, (a + t * (b - a) - p).norm());
    }
    ASSERT_EQ(around(position), distance <= 0.1);
    ASSERT_EQ(polygon(position), inside);
    near_count += around(position) ? 1 : 0;
    inside_count += inside ? 1 : 0;
  }
  EXPECT_GT(near_count, 300);
  EXPECT_GT(inside_count, 500);
}

TEST(MapCrop, HalvesMergeIntoTheEntriesOfTheWhole) {
  const WeightedVoxelMap map = slab();
  const auto isLeft = [](const Eigen::Vector3d& centre_m) { return centre_m.x() + 0.3 * centre_m.y() < 0.4; };
  const auto isRight = [&](const Eigen::Vector3d& centre_m) { return !isLeft(centre_m); };
  WeightedMapBuilder builder(map.resolution());
  builder.merge(cropMap(map, isRight));
  builder.merge(cropMap(map, isLeft));
  const WeightedVoxelMap whole = builder.build();
  ASSERT_EQ(whole.entries().size(), map.entries().size());
  for (std::size_t i = 0; i < map.entries().size(); ++i) {
    ASSERT_EQ(whole.entries()[i].voxel, map.entries()[i].voxel);
    ASSERT_EQ(whole.entries()[i].label, map.entries()[i].label);
    ASSERT_EQ(whole.entries()[i].sums, map.entries()[i].sums);
    ASSERT_EQ(whole.entries()[i].scan_count, map.entries()[i].scan_count);
  }
  EXPECT_EQ(whole.origin().point_count, map.origin().point_count);
  EXPECT_EQ(whole.origin().scan_count, 2 * map.origin().scan_count);
}

// What lies on the tiles of a larger map, with an origin.
WeightedVoxelMap town() {
  WeightedMapBuilder builder(0.4);
  builder.setMapOrigin({1000.0, 2000.0, 0.0});
  for (unsigned scan = 0; scan < 2; ++scan) {
    addCloud(builder, mixedCloud(scan, 6000, 100.0F), Eigen::Isometry3d::Identity());
  }
  return builder.build();
}

std::vector<MapRegion> regionsOfTown() {
  const std::vector<Eigen::Vector2d> line = {{-90.0, -20.0}, {-10.0, 30.0}, {60.0, 30.0}, {80.0, -70.0}};
  const MapRegion box = boxRegion({-30.0, 4.0, -2.0}, {25.6, 60.0, 9.0});
  return {box,
          polygonRegion(line),
          regionAround(line, 12.0),
          commonRegion(box, regionAround(line, 30.0)),
          boxRegion({-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}),
          [](const Eigen::Vector3d& position_m) { return position_m.x() * position_m.y() > 900.0; }};
}

TEST(MapCrop, OfAFileIsThatOfTheMap) {
  const TemporaryFolder folder;
  const auto path = [&](const std::string& name) { return (folder.path() / name).string(); };
  const WeightedVoxelMap map = town();
  map.save(path("town.map"));
  for (const MapRegion& region : regionsOfTown()) {
    const WeightedVoxelMap cropped = cropMap(map, region);
    cropped.save(path("expected.map"));
    const std::string expected = contentOf(path("expected.map"));
    for (const int threads : {1, 2}) {
      const CroppedMap written = cropMapFile(path("town.map"), region, path("part.map"), threads);
      EXPECT_TRUE(contentOf(path("part.map")) == expected);
      EXPECT_EQ(written.origin.point_count, cropped.origin().point_count);
      EXPECT_EQ(written.origin.map_origin_m, Eigen::Vector3d(1000.0, 2000.0, 0.0));
      EXPECT_EQ(written.point_count_before, map.origin().point_count);
      EXPECT_EQ(written.entry_count, cropped.entries().size());
      EXPECT_EQ(written.voxel_count, cropped.voxelCount());
      EXPECT_EQ(written.file_bytes, expected.size());
      WeightedVoxelMap::load(path("town.map"), region, threads).save(path("loaded.map"));
      EXPECT_TRUE(contentOf(path("loaded.map")) == expected);
    }
  }
  cropMapFile(path("town.map"), regionsOfTown().front(), path("town.map"));
  cropMap(map, regionsOfTown().front()).save(path("expected.map"));
  EXPECT_TRUE(contentOf(path("town.map")) == contentOf(path("expected.map")));
}

TEST(MapCrop, OfAFileReadsOnlyTheTilesThatCanMeetTheRegion) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "town.map").string(), part = (folder.path() / "part.map").string();
  const WeightedVoxelMap map = town();
  map.save(file);
  std::string damaged = contentOf(file);
  damaged[damaged.size() - 3] = static_cast<char>(damaged[damaged.size() - 3] ^ 4);  // of the last tile
  folder.write("town.map", damaged);
  expectThrows<Error>([&] { WeightedVoxelMap::load(file); }, {"town.map: offset ", "checksum of a tile"});
  const MapRegion low = boxRegion({-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, -0.4});
  EXPECT_EQ(WeightedVoxelMap::load(file, low).entries().size(), cropMap(map, low).entries().size());
  cropMapFile(file, low, part);
  const MapRegion high = boxRegion({-kInfinity, -kInfinity, 0.0}, {kInfinity, kInfinity, kInfinity});
  const std::string before = contentOf(part);
  expectThrows<Error>([&] { WeightedVoxelMap::load(file, high); }, {"town.map: offset ", "checksum of a tile"});
  expectThrows<Error>([&] { cropMapFile(file, high, part); }, {"town.map: offset ", "checksum of a tile"});
  const MapRegion far = boxRegion({500.0, 500.0, 0.0}, {600.0, 600.0, 10.0});
  EXPECT_TRUE(WeightedVoxelMap::load(file, far).entries().empty());
  expectThrows<Error>([&] { cropMapFile(file, far, part); }, {"town.map: none of its voxels", "nothing is left"});
  expectThrows<Error>([&] { cropMapFile(part + ".none", low, part); }, {"part.map.none: No such file"});
  EXPECT_TRUE(contentOf(part) == before);
  EXPECT_EQ(folder.entryCount(), 2U);
}

}  // namespace
}  // namespace saw_ndt
