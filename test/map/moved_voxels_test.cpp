#include "saw_ndt/map/moved_voxels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "common/executor.h"
#include "common/instruction_set.h"
#include "expect_throws.h"
#include "map/passing_car.h"
#include "saw_ndt/map/weighted_map_builder.h"

namespace saw_ndt {

using namespace internal;

namespace {

Eigen::Vector3d meanOf(const LabelledVoxelSums& entry, double resolution_m) {
  Eigen::Vector3d mean = entry.voxel.cast<double>().array() + 0.5;
  for (int axis = 0; axis < 3; ++axis) {
    mean[axis] += static_cast<double>(entry.sums.sum[static_cast<std::size_t>(axis)]) /
                  static_cast<double>(entry.sums.count) / kStepsPerVoxel;
  }
  return resolution_m * mean;
}

bool same(const LabelledVoxelSums& a, const LabelledVoxelSums& b) {
  return a.voxel == b.voxel && a.label == b.label && a.sums == b.sums && a.scan_count == b.scan_count;
}

bool same(const WeightedVoxelMap& a, const WeightedVoxelMap& b) {
  return a.origin().point_count == b.origin().point_count &&
         std::equal(a.entries().begin(), a.entries().end(), b.entries().begin(), b.entries().end(),
                    [](const LabelledVoxelSums& of_a, const LabelledVoxelSums& of_b) { return same(of_a, of_b); });
}

class DriveAmongTraffic : public testing::Test {
 protected:
  static constexpr double kResolution_m = 0.5;

  // Ground is labelled by its height, which is 0.
  static WeightedVoxelMap mapOf(const SyntheticDrive& drive, bool labelled) {
    WeightedMapBuilder builder(kResolution_m);
    for (std::size_t i = 0; i < drive.scans.size(); ++i) {
      std::vector<StructuralLabel> labels;
      for (const LidarPoint& point : drive.scans[i]) {
        labels.push_back(point.z + 1.73F < 0.1F ? StructuralLabel::GROUND : StructuralLabel::NON_GROUND);
      }
      builder.addScan(viewOf(drive.scans[i]), labelled ? LabelView(labels) : LabelView(), drive.T_map_lidar[i]);
    }
    return std::move(builder).build();
  }

  static WeightedVoxelMap remainingOf(const WeightedVoxelMap& map, const SyntheticDrive& drive,
                                      const std::vector<std::size_t>& order, int threads) {
    MovedVoxels moved(map);
    forEachChunkOffline(threads, order.size(), [&](std::size_t i, int) {
      moved.addScan(viewOf(drive.scans[order[i]]), drive.T_map_lidar[order[i]]);
    });
    return moved.remaining();
  }
  static WeightedVoxelMap remainingOf(const WeightedVoxelMap& map, const SyntheticDrive& drive) {
    return remainingOf(map, drive, inOrder(drive), 1);
  }
  static std::vector<std::size_t> inOrder(const SyntheticDrive& drive) {
    std::vector<std::size_t> order(drive.scans.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    return order;
  }

  static const SyntheticDrive& drive() {
    static const SyntheticDrive made = driveAmongTraffic(SensorModel::named("OS1-32"), 40);
    return made;
  }
};

TEST_F(DriveAmongTraffic, WhatPassedGoesAndWhatStandsStaysWhole) {
  for (const bool labelled : {true, false}) {
    const WeightedVoxelMap map = mapOf(drive(), labelled);
    const WeightedVoxelMap remaining = remainingOf(map, drive());
    std::uint64_t passing = 0, passing_removed = 0, standing_removed = 0, points = 0;
    auto kept = remaining.entries().begin();
    for (const LabelledVoxelSums& entry : map.entries()) {
      const bool stays = kept != remaining.entries().end() && same(*kept, entry);
      if (stays) ++kept;
      // Without labels, voxels at the ground hold some of both: their mean says which more of.
      if (isOnTheLane(meanOf(entry, kResolution_m)) && entry.label != StructuralLabel::GROUND) {
        passing += entry.sums.count;
        if (!stays) passing_removed += entry.sums.count;
      } else if (!stays) {
        standing_removed += entry.sums.count;
      }
      if (stays) points += entry.sums.count;
    }
    EXPECT_TRUE(kept == remaining.entries().end());
    EXPECT_GT(passing, 3000U);
    // What was at places that fewer than three scans saw without it, at either end, stays.
    EXPECT_GT(static_cast<double>(passing_removed), 0.7 * static_cast<double>(passing)) << labelled;
    // Parked cars, poles, walls and ground.
    EXPECT_EQ(standing_removed, 0U) << labelled;
    EXPECT_EQ(remaining.origin().point_count, points);
    EXPECT_EQ(remaining.origin().scan_count, map.origin().scan_count);
  }
}

// A car that stands in all of the scans is at the same place as the one that passes.
TEST_F(DriveAmongTraffic, WithoutTrafficNothingGoes) {
  SyntheticDrive standing = drive();
  std::vector<Block> blocks = streetBlocks();
  blocks.push_back({{4.0, 0.8, 0.3}, {8.2, 2.6, 1.5}});
  for (std::size_t i = 0; i < standing.scans.size(); ++i) {
    standing.scans[i] =
        scanBlocks(blocks, SensorModel::named("OS1-32"), standing.T_map_lidar[i], static_cast<unsigned>(i));
  }
  for (const bool labelled : {true, false}) {
    const WeightedVoxelMap map = mapOf(standing, labelled);
    EXPECT_TRUE(same(remainingOf(map, standing), map)) << labelled;
  }
}

TEST_F(DriveAmongTraffic, ThreadsOrderAndInstructionsDoNotMatter) {
  const WeightedVoxelMap map = mapOf(drive(), true);
  const WeightedVoxelMap expected = remainingOf(map, drive());
  EXPECT_LT(expected.entries().size(), map.entries().size());
  std::vector<std::size_t> order = inOrder(drive());
  std::reverse(order.begin(), order.end());
  std::swap(order[3], order[20]);
  for (const int threads : {1, 2, 4}) {
    EXPECT_TRUE(same(remainingOf(map, drive(), order, threads), expected)) << threads;
  }
  for (const InstructionSet set : kInstructionSets) {
    limitInstructionSet(set);
    EXPECT_TRUE(same(remainingOf(map, drive()), expected)) << toString(set);
  }
  limitInstructionSet(InstructionSet::AVX512);
}

TEST_F(DriveAmongTraffic, TheFrameOfTheMapHardlyMatters) {
  // Turned, and as far from the origin as projected coordinates are.
  SyntheticDrive elsewhere = drive();
  Eigen::Isometry3d T_there_ground = Eigen::Isometry3d::Identity();
  T_there_ground.linear() = rotationFromVector({0.0, 0.0, 0.7});
  T_there_ground.translation() << 456789.1, 5432109.2, 123.4;
  for (Eigen::Isometry3d& T_map_lidar : elsewhere.T_map_lidar) T_map_lidar = T_there_ground * T_map_lidar;
  const auto removed = [](const WeightedVoxelMap& map, const SyntheticDrive& of) {
    return static_cast<double>(map.origin().point_count - remainingOf(map, of).origin().point_count);
  };
  const double here = removed(mapOf(drive(), true), drive());
  // Voxels cut the scene elsewhere.
  EXPECT_NEAR(removed(mapOf(elsewhere, true), elsewhere), here, 0.05 * here);
}

TEST_F(DriveAmongTraffic, WithoutScansAndWithoutPointsNothingGoes) {
  const WeightedVoxelMap map = mapOf(drive(), true);
  MovedVoxels moved(map);
  EXPECT_TRUE(same(moved.remaining(), map));
  moved.addScan(ScanView(), Eigen::Isometry3d::Identity());
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<LidarPoint> bad(1000, {kNan, 1.0F, 1.0F, 0.0F});
  for (int i = 0; i < 10; ++i) moved.addScan(viewOf(bad), drive().T_map_lidar.front());
  EXPECT_TRUE(same(moved.remaining(), map));
  EXPECT_TRUE(same(moved.map(), map));
  MovedVoxels of_nothing{WeightedVoxelMap()};
  of_nothing.addScan(viewOf(drive().scans.front()), drive().T_map_lidar.front());
  EXPECT_TRUE(of_nothing.remaining().entries().empty());
}

TEST(MovedVoxels, WhatDoesNotHoldIsNamed) {
  const WeightedVoxelMap nothing;
  for (const double share : {0.0, -0.1, 0.51, std::numeric_limits<double>::quiet_NaN()}) {
    MovedVoxelOptions options;
    options.max_hit_share = share;
    expectThrows<std::invalid_argument>([&] { MovedVoxels(nothing, options); }, {"max_hit_share"});
  }
  for (const double range_m : {0.0, -1.0, std::numeric_limits<double>::infinity()}) {
    MovedVoxelOptions options;
    options.max_range_m = range_m;
    expectThrows<std::invalid_argument>([&] { MovedVoxels(nothing, options); }, {"max_range_m"});
  }
  LabelledVoxelSums entry{{0, 0, 0}, StructuralLabel::NON_GROUND, {}, 0};
  entry.sums.add({0, 0, 0});
  const WeightedVoxelMap old(MapOrigin(), {entry});
  expectThrows<std::invalid_argument>([&] { MovedVoxels{old}; }, {"how many scans met"});
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation().x() = std::numeric_limits<double>::quiet_NaN();
  expectThrows<std::invalid_argument>([&] { MovedVoxels(nothing).addScan(ScanView(), T); }, {"T_map_scan"});
}

}  // namespace
}  // namespace saw_ndt
