#include "map/ndt_level.h"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "map_fixtures.h"

namespace saw_ndt {
namespace {

using Key = std::tuple<int, int, int>;

int floorDivide(int value, int divisor) { return static_cast<int>(std::floor(static_cast<double>(value) / divisor)); }

Eigen::Vector3d positionOf(const pcl::PointXYZ& point) { return point.getVector3fMap().cast<double>(); }

TEST(NdtLevel, CoarseVoxelsAreTheExactSumsOfTheirPoints) {
  constexpr double kResolution_m = 0.5;
  const pcl::PointCloud<pcl::PointXYZ> cloud = withoutLabels(mixedCloud(2, 6000));
  for (const int factor : {2, 3, 4}) {
    VoxelWeighting weighting;
    weighting.coarse_factor = factor;
    const NdtLevel coarse = mapOf(cloud, kResolution_m, weighting).coarse();
    EXPECT_EQ(coarse.resolution(), factor * kResolution_m);

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
      const std::int32_t found = coarse.index().find(voxel);
      ASSERT_EQ(found != VoxelIndex::kNone, expected.has_value());
      if (!expected) continue;
      ++expected_count;
      const VoxelStatistics statistics = coarse.voxel(static_cast<std::size_t>(found));
      EXPECT_EQ(statistics.voxel, voxel);
      EXPECT_EQ(statistics.point_count, expected->point_count);
      EXPECT_EQ(statistics.mean_from_centre, expected->mean_from_centre);
      EXPECT_EQ(statistics.inverse_covariance.triangularView<Eigen::Upper>().toDenseMatrix(),
                expected->inverse_covariance.triangularView<Eigen::Upper>().toDenseMatrix());
      EXPECT_EQ(statistics.structure_class, expected->structure_class);
      EXPECT_EQ(statistics.weight, expected->weight);
    }
    EXPECT_EQ(coarse.size(), expected_count);
  }
}

TEST(NdtLevel, CoarseVoxelsAreThoseOfTheirSizeBuiltDirectly) {
  const pcl::PointCloud<pcl::PointXYZL> cloud = mixedCloud(3, 6000);
  const WeightedVoxelMap fine_and_coarse = mapOf(cloud, 1.0);
  const WeightedVoxelMap direct = mapOf(cloud, 3.0);
  ASSERT_EQ(fine_and_coarse.coarse().size(), direct.fine().size());
  const double half_steps_m = 0.5 * (1.0 + 3.0) / kStepsPerVoxel;  // the rounding of both
  for (std::size_t i = 0; i < direct.fine().size(); ++i) {
    const VoxelStatistics expected = direct.fine().voxel(i);
    const std::int32_t found = fine_and_coarse.coarse().index().find(expected.voxel);
    ASSERT_NE(found, VoxelIndex::kNone);
    const VoxelStatistics voxel = fine_and_coarse.coarse().voxel(static_cast<std::size_t>(found));
    EXPECT_EQ(voxel.point_count, expected.point_count);
    EXPECT_DOUBLE_EQ(voxel.mean_confidence, expected.mean_confidence);
    EXPECT_LE((voxel.mean(3.0) - expected.mean(3.0)).cwiseAbs().maxCoeff(), half_steps_m);
    EXPECT_LE((voxel.covariance - expected.covariance).norm(), 1e-3 * expected.covariance.norm());
  }
}

TEST(NdtLevel, FindsTheVoxelOfAPosition) {
  const WeightedVoxelMap map = mapOf(mixedCloud(4, 4000));
  for (const NdtLevel* level : {&map.fine(), &map.coarse()}) {
    ASSERT_FALSE(level->empty());
    for (std::size_t i = 0; i < level->size(); ++i) {
      const VoxelStatistics voxel = level->voxel(i);
      EXPECT_EQ(level->find(voxel.mean(level->resolution())), static_cast<std::int32_t>(i));
    }
    EXPECT_EQ(level->find({900.0, 0.0, 0.0}), VoxelIndex::kNone);
    EXPECT_EQ(level->find({std::nan(""), 0.0, 0.0}), VoxelIndex::kNone);
    EXPECT_EQ(level->find({1e300, 0.0, 0.0}), VoxelIndex::kNone);
    EXPECT_THROW(level->voxel(level->size()), std::out_of_range);
  }
}

TEST(NdtLevel, AFactorOfOneMeansNoCoarseLevel) {
  VoxelWeighting weighting;
  weighting.coarse_factor = 1;
  const WeightedVoxelMap map = mapOf(mixedCloud(4, 1000), 1.0, weighting);
  EXPECT_TRUE(map.coarse().empty());
  EXPECT_FALSE(map.empty());
  EXPECT_TRUE(WeightedVoxelMap().empty());
}

}  // namespace
}  // namespace saw_ndt
