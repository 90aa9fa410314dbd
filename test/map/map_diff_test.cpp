#include "saw_ndt/map/map_diff.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "expect_throws.h"
#include "map/map_fixtures.h"

namespace saw_ndt {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZL>;

/// A yard of 24 m by 24 m with a wall along x, and what may stand in it. Metres.
struct Yard {
  double wall_y = 8.1;
  bool has_wall = true;
  bool has_car = false;  ///< 4 m x 1.8 m x 1.5 m, around (-4, -3)
  double ground_z = -1.7;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  double greatest_x = 12.0;  ///< of what the scans see
  int scans_of_car = 100;    ///< that meet it
};

constexpr double kCarX = -4.0, kCarY = -3.0;

/// One scan: points spread evenly over all surfaces, each 2 cm off along its normal.
Cloud scanOf(const Yard& yard, std::mt19937& random, bool with_car) {
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::normal_distribution<double> noise(0.0, 0.02);
  Cloud cloud;
  const auto add = [&](double x, double y, double z, std::uint32_t label) {
    if (x > yard.greatest_x) return;
    pcl::PointXYZL point;
    point.getVector3fMap() = Eigen::Vector3d(x, y, z).cast<float>();
    point.label = label;
    cloud.push_back(point);
  };
  const auto between = [&](double low, double high) { return low + (high - low) * share(random); };
  const auto isUnderCar = [&](double x, double y) { return std::abs(x - kCarX) < 2.0 && std::abs(y - kCarY) < 0.9; };
  for (int i = 0; i < 6000; ++i) {
    const double x = between(-12, 12), y = between(-12, 12);
    if (with_car && isUnderCar(x, y)) continue;
    if (yard.has_wall && y > yard.wall_y) continue;
    add(x, y, yard.ground_z + noise(random), 1);
  }
  for (int i = 0; i < 1000 && yard.has_wall; ++i) {
    add(between(-10, 10), yard.wall_y + noise(random), yard.ground_z + between(0, 3), 2);
  }
  for (int i = 0; i < 400 && with_car; ++i) {
    const double x = kCarX + between(-2, 2), y = kCarY + between(-0.9, 0.9), z = yard.ground_z + between(0.2, 1.5);
    const int side = i % 5;
    if (side == 0) add(x, y, yard.ground_z + 1.5 + noise(random), 2);
    if (side == 1 || side == 2) add(x, kCarY + (side == 1 ? -0.9 : 0.9) + noise(random), z, 2);
    if (side == 3 || side == 4) add(kCarX + (side == 3 ? -2 : 2) + noise(random), y, z, 2);
  }
  return cloud;
}

/// A map of ten scans, of voxels of 0.5 m.
WeightedVoxelMap mapOfYard(const Yard& yard, unsigned seed) {
  std::mt19937 random(seed);
  WeightedMapBuilder builder(0.5);
  Eigen::Isometry3d T_map_yard = Eigen::Isometry3d::Identity();
  T_map_yard.translation() = yard.origin;
  for (int scan = 0; scan < 10; ++scan) {
    addCloud(builder, scanOf(yard, random, yard.has_car && scan < yard.scans_of_car), T_map_yard);
  }
  return builder.build();
}

std::size_t countOf(const MapDiff& diff, VoxelChange change) {
  return static_cast<std::size_t>(std::count_if(diff.changes.begin(), diff.changes.end(),
                                                [change](const ChangedVoxel& c) { return c.change == change; }));
}

void expectConsistent(const MapDiffSide& side) {
  EXPECT_EQ(side.unchanged + side.changed + side.moved + side.not_covered, side.compared);
  EXPECT_LE(side.compared, side.voxels);
}

/// Expects that nothing has changed.
void expectNoChange(const MapDiff& diff) {
  EXPECT_TRUE(diff.changes.empty());
  EXPECT_TRUE(diff.groups.empty());
  for (const MapDiffSide* side : {&diff.first, &diff.second}) {
    expectConsistent(*side);
    EXPECT_EQ(side->unchanged, side->compared);
  }
}

TEST(MapDiff, OtherScansOfTheSamePlaceChangeNothing) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Yard yard;
    yard.has_car = seed % 2 == 0;
    const MapDiff diff = diffMaps(mapOfYard(yard, seed), mapOfYard(yard, 100 + seed));
    expectNoChange(diff);
    EXPECT_GT(diff.first.compared, 2000U);
    // Means of some 26 points with 2 cm of noise each, in both maps.
    EXPECT_GT(diff.gap_count, 1500U);
    EXPECT_NEAR(diff.gap_percentiles_m[1], 0.0, 0.001);
    EXPECT_NEAR(diff.gap_percentiles_m[2], 1.645 * 0.02 * std::sqrt(2.0 / 26.0), 0.002);
  }
}

TEST(MapDiff, ACarThatStandsThereNowHasAppeared) {
  Yard before, after;
  after.has_car = true;
  const MapDiff diff = diffMaps(mapOfYard(before, 1), mapOfYard(after, 2));
  ASSERT_EQ(diff.groups.size(), 1U);
  const ChangedGroup& car = diff.groups.front();
  EXPECT_EQ(car.change, VoxelChange::APPEARED);
  // Its sides and top, less its foot, which is among the ground's voxels.
  EXPECT_GE(car.least_m.x(), kCarX - 2.5);
  EXPECT_LE(car.greatest_m.x(), kCarX + 2.5);
  EXPECT_GE(car.least_m.y(), kCarY - 1.5);
  EXPECT_LE(car.greatest_m.y(), kCarY + 1.5);
  EXPECT_GE((car.greatest_m - car.least_m).x(), 4.0);
  EXPECT_GE((car.greatest_m - car.least_m).y(), 1.5);
  EXPECT_NEAR(car.greatest_m.z(), 0.0, 0.51);
  EXPECT_EQ(diff.changes.size(), diff.second.changed);
  EXPECT_EQ(car.voxels, diff.changes.size());
  // The ground below the car is out of sight, not gone.
  EXPECT_EQ(diff.first.changed, 0U);
  EXPECT_GT(diff.first.not_covered, 5U);
  EXPECT_EQ(diff.first.moved + diff.second.moved, 0U);
}

TEST(MapDiff, AWallTakenDownHasVanished) {
  Yard before, after;
  after.has_wall = false;
  const MapDiff diff = diffMaps(mapOfYard(before, 1), mapOfYard(after, 2));
  // 40 columns of voxels. The lowest voxel is that of the ground, the next one touches it and counts in part; the three
  // above lie within 2 m of the ground that is seen now, and higher than that nothing is seen.
  EXPECT_GE(diff.first.changed, 40U * 3U - 2U);
  EXPECT_LE(diff.first.changed, 40U * 4U);
  EXPECT_EQ(countOf(diff, VoxelChange::VANISHED), diff.first.changed);
  ASSERT_FALSE(diff.groups.empty());
  EXPECT_NEAR(diff.groups.front().least_m.x(), -10.0, 0.01);
  EXPECT_NEAR(diff.groups.front().greatest_m.x(), 10.0, 0.01);
  EXPECT_NEAR(diff.groups.front().least_m.y(), 8.0, 0.01);
  EXPECT_NEAR(diff.groups.front().greatest_m.y(), 8.5, 0.01);
  // What was behind it had not been seen.
  EXPECT_EQ(diff.second.changed, 0U);
  EXPECT_GT(diff.second.not_covered, 200U);
}

TEST(MapDiff, AWallThatWasShiftedHasMovedAlongItsNormal) {
  // Within its voxel, into the next one, and by nearly a voxel; either way.
  for (const double by_m : {0.15, 0.25, 0.45, -0.2, -0.4}) {
    SCOPED_TRACE(by_m);
    Yard before, after;
    after.wall_y += by_m;
    const MapDiff diff = diffMaps(mapOfYard(before, 1), mapOfYard(after, 2));
    EXPECT_GT(diff.first.moved, 150U);
    EXPECT_GT(diff.second.moved, 150U);
    ASSERT_FALSE(diff.groups.empty());
    EXPECT_EQ(diff.groups.front().change, VoxelChange::MOVED);
    EXPECT_NEAR(diff.groups.front().displacement_m.y(), by_m, 0.005);
    for (const ChangedVoxel& changed : diff.changes) {
      ASSERT_EQ(changed.change, VoxelChange::MOVED);
      // Means of some 26 points with 2 cm of noise each, in both maps, and what their normals add: 5 standard
      // deviations.
      EXPECT_NEAR(changed.displacement_m.y(), by_m, 5.0 * 0.02 * std::sqrt(2.0 * 2.0 / 26.0));
      EXPECT_LT(std::abs(changed.displacement_m.x()), 0.04);
      EXPECT_NEAR(changed.mean_m.y(), changed.in_second ? 8.1 + by_m : 8.1, 0.03);
    }
    expectConsistent(diff.first);
    expectConsistent(diff.second);
  }
}

TEST(MapDiff, ALeastDisplacementIsAskedFor) {
  Yard before, after;
  after.wall_y += 0.06;
  after.ground_z += 0.06;
  expectNoChange(diffMaps(mapOfYard(before, 1), mapOfYard(after, 2)));
  MapDiffOptions options;
  options.least_displacement_m = 0.03;
  const MapDiff diff = diffMaps(mapOfYard(before, 1), mapOfYard(after, 2), options);
  EXPECT_GT(diff.first.moved, 1500U);
  EXPECT_NEAR(diff.gap_percentiles_m[1], 0.06, 0.002);
}

TEST(MapDiff, WhatTheOtherMapHasNotSeenIsNotCovered) {
  Yard whole, part;
  whole.has_car = true;
  part.greatest_x = 0.0;
  const MapDiff diff = diffMaps(mapOfYard(whole, 1), mapOfYard(part, 2));
  // The car vanishes, the half of the yard beyond x = 0 does not.
  EXPECT_GT(diff.first.not_covered, 1000U);
  EXPECT_GT(diff.first.changed, 20U);
  for (const ChangedVoxel& changed : diff.changes) EXPECT_LT(changed.mean_m.x(), 0.0);
  EXPECT_EQ(diff.second.changed, 0U);

  Yard elsewhere;
  elsewhere.origin = {1000.0, 0.0, 0.0};
  const MapDiff nothing = diffMaps(mapOfYard(whole, 1), mapOfYard(elsewhere, 2));
  EXPECT_TRUE(nothing.changes.empty());
  EXPECT_EQ(nothing.first.not_covered, nothing.first.compared);
  EXPECT_EQ(nothing.second.not_covered, nothing.second.compared);
  EXPECT_EQ(nothing.gap_count, 0U);
}

TEST(MapDiff, WhatFewOfManyScansMetIsNotCompared) {
  Yard before, after;
  after.has_car = true;
  after.scans_of_car = 4;
  MapDiffOptions options;
  options.least_points = 4;
  options.least_share_of_scans = 0.5;
  EXPECT_EQ(diffMaps(mapOfYard(before, 1), mapOfYard(after, 2), options).second.changed, 0U);
  options.least_share_of_scans = 0.3;
  EXPECT_GT(diffMaps(mapOfYard(before, 1), mapOfYard(after, 2), options).second.changed, 10U);
}

TEST(MapDiff, WhatFewScansMetIsNotCompared) {
  Yard before, after;
  after.has_car = true;
  after.scans_of_car = 2;
  expectNoChange(diffMaps(mapOfYard(before, 1), mapOfYard(before, 2)));
  const MapDiff diff = diffMaps(mapOfYard(before, 1), mapOfYard(after, 2));
  EXPECT_EQ(diff.changes.size(), 0U);
  MapDiffOptions options;
  options.least_points = 4;
  EXPECT_EQ(diffMaps(mapOfYard(before, 1), mapOfYard(after, 2), options).changes.size(), 0U);
  options.least_scans = 2;
  EXPECT_GT(diffMaps(mapOfYard(before, 1), mapOfYard(after, 2), options).second.changed, 10U);
}

void expectMirrored(const MapDiff& a, const MapDiff& b) {
  EXPECT_TRUE(a.first == b.second);
  EXPECT_TRUE(a.second == b.first);
  EXPECT_EQ(a.gap_count, b.gap_count);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(a.gap_percentiles_m[i], -b.gap_percentiles_m[2 - i]);
  const auto mirrored = [](VoxelChange change) {
    return change == VoxelChange::APPEARED   ? VoxelChange::VANISHED
           : change == VoxelChange::VANISHED ? VoxelChange::APPEARED
                                             : change;
  };
  ASSERT_EQ(a.changes.size(), b.changes.size());
  // The changes of the first map come first, those of the second then.
  const std::size_t of_first = a.first.changed + a.first.moved, of_second = a.changes.size() - of_first;
  for (std::size_t i = 0; i < a.changes.size(); ++i) {
    const ChangedVoxel& here = a.changes[i];
    const ChangedVoxel& there = b.changes[i < of_first ? i + of_second : i - of_first];
    ASSERT_EQ(here.voxel, there.voxel);
    EXPECT_EQ(here.change, mirrored(there.change));
    EXPECT_NE(here.in_second, there.in_second);
    EXPECT_EQ(here.mean_m, there.mean_m);
    EXPECT_EQ(here.displacement_m, -there.displacement_m);
    EXPECT_EQ(a.groups[here.group].least_m, b.groups[there.group].least_m);
  }
  ASSERT_EQ(a.groups.size(), b.groups.size());
  for (std::size_t i = 0; i < a.groups.size(); ++i) EXPECT_EQ(a.groups[i].voxels, b.groups[i].voxels);
}

TEST(MapDiff, TheOtherOrderGivesTheMirrorImage) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    Yard before, after;
    before.has_car = seed % 2 == 0;
    after.has_car = !before.has_car;
    after.wall_y += 0.05 + 0.1 * seed;
    MapDiffOptions options;
    options.least_voxels = static_cast<int>(seed);
    const WeightedVoxelMap a = mapOfYard(before, seed), b = mapOfYard(after, 10 + seed);
    const MapDiff forwards = diffMaps(a, b, options);
    EXPECT_GT(forwards.changes.size(), 100U);
    expectMirrored(forwards, diffMaps(b, a, options));
  }
}

TEST(MapDiff, DependsOnNoLabelThreadOrPlace) {
  Yard before, after;
  after.has_car = true;
  after.wall_y += 0.25;
  const WeightedVoxelMap a = mapOfYard(before, 1), b = mapOfYard(after, 2);
  const MapDiff expected = diffMaps(a, b, {}, 1);
  const auto expectSame = [&expected](const MapDiff& diff, const Eigen::Vector3d& shift_m) {
    EXPECT_TRUE(diff.first == expected.first);
    EXPECT_TRUE(diff.second == expected.second);
    ASSERT_EQ(diff.changes.size(), expected.changes.size());
    std::vector<double> moved, expected_moved;
    double error_m = 0.0;
    for (const ChangedVoxel& changed : diff.changes) moved.push_back(changed.displacement_m.norm());
    for (const ChangedVoxel& changed : expected.changes) expected_moved.push_back(changed.displacement_m.norm());
    std::sort(moved.begin(), moved.end());
    std::sort(expected_moved.begin(), expected_moved.end());
    for (std::size_t i = 0; i < moved.size(); ++i) error_m = std::max(error_m, std::abs(moved[i] - expected_moved[i]));
    EXPECT_LT(error_m, 1e-3);
    ASSERT_EQ(diff.groups.size(), expected.groups.size());
    EXPECT_LT((diff.groups.front().least_m - shift_m - expected.groups.front().least_m).norm(), 1e-6);
  };
  expectSame(diffMaps(a, b, {}, 4), Eigen::Vector3d::Zero());

  // Without labels, and of one map alone: only the sums of a voxel's labels together count.
  std::mt19937 random(2);
  WeightedMapBuilder unlabelled(0.5);
  for (int scan = 0; scan < 10; ++scan) {
    addCloud(unlabelled, withoutLabels(scanOf(after, random, true)), Eigen::Isometry3d::Identity());
  }
  const MapDiff without = diffMaps(a, unlabelled.build());
  EXPECT_NEAR(static_cast<double>(without.changes.size()), static_cast<double>(expected.changes.size()), 3.0);

  // Far out, by whole voxels and tiles.
  before.origin = after.origin = {5000000.0, -320000.0, 640.0};
  expectSame(diffMaps(mapOfYard(before, 1), mapOfYard(after, 2)), before.origin);
}

TEST(MapDiff, OfEmptyMapsIsNothing) {
  const WeightedVoxelMap empty = WeightedMapBuilder(0.5).build(), yard = mapOfYard({}, 1);
  expectNoChange(diffMaps(empty, empty));
  const MapDiff diff = diffMaps(empty, yard);
  EXPECT_TRUE(diff.changes.empty());
  EXPECT_GT(diff.second.not_covered, 2000U);
  EXPECT_EQ(diff.first.voxels, 0U);
}

TEST(MapDiff, SaysWhatDoesNotHold) {
  const WeightedVoxelMap map = WeightedMapBuilder(0.5).build();
  expectThrows<std::invalid_argument>([&] { diffMaps(map, WeightedMapBuilder(1.0).build()); },
                                      {"resolution_m = 1: must be that of the other map, 0.5"});
  MapOrigin elsewhere = map.origin();
  elsewhere.map_origin_m.x() = 500000.0;
  expectThrows<std::invalid_argument>([&] { diffMaps(map, WeightedVoxelMap(elsewhere, {})); },
                                      {"map_origin_m = 5e+05 0 0: must be that of the other map, 0 0 0"});
  const auto withOption = [&map](auto set) {
    MapDiffOptions options;
    set(options);
    diffMaps(map, map, options);
  };
  expectThrows<std::invalid_argument>([&] { withOption([](MapDiffOptions& o) { o.least_points = 2; }); },
                                      {"least_points = 2"});
  expectThrows<std::invalid_argument>([&] { withOption([](MapDiffOptions& o) { o.least_scans = -1; }); },
                                      {"least_scans = -1"});
  for (const double bad : {-0.1, 1.1, std::nan("")}) {
    expectThrows<std::invalid_argument>([&] { withOption([&](MapDiffOptions& o) { o.least_share_of_scans = bad; }); },
                                        {"least_share_of_scans"});
  }
  expectThrows<std::invalid_argument>([&] { withOption([](MapDiffOptions& o) { o.least_voxels = 0; }); },
                                      {"least_voxels = 0"});
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    expectThrows<std::invalid_argument>([&] { withOption([&](MapDiffOptions& o) { o.least_displacement_m = bad; }); },
                                        {"least_displacement_m"});
  }
}

}  // namespace
}  // namespace saw_ndt
