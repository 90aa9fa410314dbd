#include "map/ndt_level.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstring>
#include <map>
#include <tuple>

#include "map/map_tile.h"
#include "map_fixtures.h"

namespace saw_ndt {

using namespace internal;

namespace {

using internal::NdtLevel;
using internal::VoxelIndex;
using Key = std::tuple<int, int, int>;

int floorDivide(int value, int divisor) { return static_cast<int>(std::floor(static_cast<double>(value) / divisor)); }

Eigen::Vector3d positionOf(const pcl::PointXYZ& point) { return point.getVector3fMap().cast<double>(); }

NdtTarget exactTargetOf(const WeightedVoxelMap& map, const VoxelWeighting& weighting = {}) {
  return NdtTarget(map, weighting, 1, CellPrecision::SINGLE_AND_DOUBLE);
}

void expectCell(const NdtLevel& level, const VoxelStatistics& expected) {
  const std::int32_t found = level.index().find(expected.voxel);
  ASSERT_NE(found, VoxelIndex::kNone);
  const internal::NdtCell& cell = level.cells()[static_cast<std::size_t>(found)];
  const internal::PackedNdtCell& packed = level.packedCells()[static_cast<std::size_t>(found)];
  int k = 0;
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(cell.mean_from_centre[i], expected.mean_from_centre[i]);
    EXPECT_EQ(packed.mean_from_centre[i], static_cast<float>(expected.mean_from_centre[i]));
    for (int j = i; j < 3; ++j, ++k) {
      EXPECT_EQ(cell.inverse_covariance[k], expected.inverse_covariance(i, j));
      EXPECT_EQ(packed.inverse_covariance[k], static_cast<float>(expected.inverse_covariance(i, j)));
    }
  }
  EXPECT_EQ(cell.weight, expected.weight);
  EXPECT_EQ(packed.weight, static_cast<float>(expected.weight));
  EXPECT_EQ(cell.mean_confidence, expected.mean_confidence);
  EXPECT_EQ(packed.mean_confidence, static_cast<float>(expected.mean_confidence));
}

TEST(NdtLevel, CellsAreTheStatisticsOfTheStore) {
  const WeightedVoxelMap map = mapOf(mixedCloud(2, 6000));
  const std::vector<VoxelStatistics> voxels = map.statistics();
  const NdtTarget target = exactTargetOf(map);
  EXPECT_EQ(target.voxelCount(), voxels.size());
  const std::vector<Eigen::Vector3d> means = target.means();
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    expectCell(target.fine(), voxels[i]);
    EXPECT_LT((means[i] - voxels[i].mean(1.0)).norm(), 1e-7);
  }
}

TEST(NdtLevel, CoarseVoxelsAreTheExactSumsOfTheirPoints) {
  constexpr double kResolution_m = 0.5;
  const pcl::PointCloud<pcl::PointXYZ> cloud = withoutLabels(mixedCloud(2, 6000));
  for (const int factor : {2, 3, 4}) {
    VoxelWeighting weighting;
    weighting.coarse_factor = factor;
    const NdtTarget target = exactTargetOf(mapOf(cloud, kResolution_m), weighting);
    EXPECT_EQ(target.coarse().resolution(), factor * kResolution_m);

    // Every point in fine steps from the centre of its coarse voxel.
    std::map<Key, VoxelSums> sums;
    for (const pcl::PointXYZ& point : cloud) {
      QuantizedPosition position;
      ASSERT_TRUE(quantize(positionOf(point), 1.0 / kResolution_m, position));
      std::array<int, 3> parent;
      std::array<std::int32_t, 3> steps;
      for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        parent[a] = floorDivide(position.voxel[axis], factor);
        const double centres_apart = position.voxel[axis] + 0.5 - (parent[a] + 0.5) * factor;
        steps[a] = position.steps[a] + static_cast<std::int32_t>(centres_apart * kStepsPerVoxel);
      }
      sums[{parent[0], parent[1], parent[2]}].add(steps);
    }
    std::size_t expected_count = 0;
    for (const auto& [key, voxel_sums] : sums) {
      const VoxelCoordinate voxel(std::get<0>(key), std::get<1>(key), std::get<2>(key));
      const auto expected = voxelStatistics(voxel, voxel_sums, 1.0, weighting, kResolution_m / kStepsPerVoxel);
      if (!expected) {
        EXPECT_EQ(target.coarse().index().find(voxel), VoxelIndex::kNone);
        continue;
      }
      ++expected_count;
      expectCell(target.coarse(), *expected);
    }
    EXPECT_EQ(target.coarseVoxelCount(), expected_count);
  }
}

TEST(NdtLevel, CoarseVoxelsAreThoseOfTheirSizeBuiltDirectly) {
  const pcl::PointCloud<pcl::PointXYZL> cloud = mixedCloud(3, 6000);
  const NdtTarget fine_and_coarse(mapOf(cloud, 1.0)), direct(mapOf(cloud, 3.0));
  ASSERT_EQ(fine_and_coarse.coarse().index().voxels(), direct.fine().index().voxels());
  const std::vector<Eigen::Vector3d> coarse_means = fine_and_coarse.coarse().means(), means = direct.means();
  const double half_steps_m = 0.5 * (1.0 + 3.0) / kStepsPerVoxel;  // the rounding of both
  for (std::size_t i = 0; i < means.size(); ++i) {
    EXPECT_LE((coarse_means[i] - means[i]).cwiseAbs().maxCoeff(), half_steps_m + 3e-7);
    EXPECT_EQ(fine_and_coarse.coarse().packedCells()[i].mean_confidence,
              direct.fine().packedCells()[i].mean_confidence);
  }
}

TEST(NdtLevel, FindsTheVoxelOfAPosition) {
  const NdtTarget target(mapOf(mixedCloud(4, 4000)));
  for (const NdtLevel* level : {&target.fine(), &target.coarse()}) {
    ASSERT_FALSE(level->empty());
    const std::vector<Eigen::Vector3d> means = level->means();
    for (std::size_t i = 0; i < level->size(); ++i) EXPECT_EQ(level->find(means[i]), static_cast<std::int32_t>(i));
    EXPECT_EQ(level->find({900.0, 0.0, 0.0}), VoxelIndex::kNone);
    EXPECT_EQ(level->find({std::nan(""), 0.0, 0.0}), VoxelIndex::kNone);
    EXPECT_EQ(level->find({1e300, 0.0, 0.0}), VoxelIndex::kNone);
  }
}

TEST(NdtLevel, DoubleCellsAreKeptOnlyWhereTheyAreAskedFor) {
  const WeightedVoxelMap map = mapOf(mixedCloud(4, 1000));
  EXPECT_FALSE(NdtTarget(map).fine().hasDoubleCells());
  EXPECT_TRUE(NdtTarget(map).fine().cells().empty());
  EXPECT_TRUE(exactTargetOf(map).fine().hasDoubleCells());
  EXPECT_TRUE(exactTargetOf(map).coarse().hasDoubleCells());
}

// What replacing a tile rests on.
TEST(NdtLevel, TheCellsOfATileFollowEachOtherAndDoNotDependOnOtherTiles) {
  const WeightedVoxelMap map = mapOf(mixedCloud(5, 40000, 60.0F), 0.5);
  const NdtTarget target(map);
  for (const NdtLevel* level : {&target.fine(), &target.coarse()}) {
    ASSERT_GT(level->tiles().size(), 2U);
    const std::vector<VoxelCoordinate> voxels = level->index().voxels();
    std::size_t next = 0;
    for (const internal::TileCells& tile : level->tiles()) {
      ASSERT_EQ(tile.first, next);
      ASSERT_GT(tile.count, 0U);
      for (std::size_t i = next; i < next + tile.count; ++i) EXPECT_EQ(internal::tileOf(voxels[i]), tile.tile);
      next += tile.count;
    }
    EXPECT_EQ(next, level->size());
  }
  for (const internal::TileCells& tile : target.fine().tiles()) {
    std::vector<LabelledVoxelSums> entries;
    for (const LabelledVoxelSums& entry : map.entries()) {
      if (internal::tileOf(entry.voxel) == tile.tile) entries.push_back(entry);
    }
    const NdtTarget alone(WeightedVoxelMap(map.origin(), entries));
    ASSERT_EQ(alone.voxelCount(), tile.count);
    for (std::size_t i = 0; i < tile.count; ++i) {
      // Eleven floats, and what fills the cache line.
      ASSERT_EQ(std::memcmp(&alone.fine().packedCells()[i], &target.fine().packedCells()[tile.first + i],
                            offsetof(internal::PackedNdtCell, mean_confidence) + sizeof(float)),
                0);
    }
    const std::vector<VoxelCoordinate> voxels = target.fine().index().voxels();
    const auto first = voxels.begin() + tile.first;
    EXPECT_EQ(alone.fine().index().voxels(), std::vector<VoxelCoordinate>(first, first + tile.count));
  }
}

}  // namespace
}  // namespace saw_ndt
