#include "saw_ndt/map/weighted_voxel_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "expect_throws.h"
#include "map_fixtures.h"

namespace saw_ndt {
namespace {

TEST(WeightedVoxelMap, UniformConfidencesEqualAnUnlabelledMapBitForBit) {
  VoxelWeighting uniform;
  uniform.confidence = ConfidenceOptions::uniform();
  const pcl::PointCloud<pcl::PointXYZL> cloud = mixedCloud(6, 8000);
  const WeightedVoxelMap labelled = mapOf(cloud, 1.0);
  const WeightedVoxelMap unlabelled = mapOf(withoutLabels(cloud));
  expectEqualTargets(NdtTarget(labelled, uniform), NdtTarget(unlabelled));
  EXPECT_GT(labelled.entries().size(), unlabelled.entries().size());
}

TEST(WeightedVoxelMap, FindsTheStatisticsOfEachVoxelAndOfNoOther) {
  const WeightedVoxelMap map = mapOf(mixedCloud(6, 5000));
  VoxelWeighting weighting;
  weighting.confidence = ConfidenceOptions::paper();
  const std::vector<VoxelStatistics> voxels = map.statistics(weighting, 2);
  ASSERT_GT(voxels.size(), 100U);
  EXPECT_EQ(map.voxelCount(weighting, 2), voxels.size());
  EXPECT_GT(map.voxelCount(), voxels.size());
  for (const VoxelStatistics& expected : voxels) {
    const auto found = map.find(expected.mean(map.resolution()), weighting);
    ASSERT_TRUE(found);
    ASSERT_EQ(found->voxel, expected.voxel);
    ASSERT_EQ(found->point_count, expected.point_count);
    ASSERT_EQ(found->mean_from_centre, expected.mean_from_centre);
    ASSERT_EQ(found->covariance, expected.covariance);
    ASSERT_EQ(found->weight, expected.weight);
  }
  EXPECT_FALSE(map.find({900.0, 0.0, 0.0}));
  EXPECT_FALSE(map.find({-900.0, 0.0, 0.0}));
  EXPECT_FALSE(map.find({std::nan(""), 0.0, 0.0}));
  EXPECT_FALSE(map.find({1e300, 0.0, 0.0}));
  EXPECT_FALSE(WeightedVoxelMap().find({0.0, 0.0, 0.0}));
  EXPECT_TRUE(WeightedVoxelMap().statistics().empty());
}

TEST(WeightedVoxelMap, RefusesAVoxelAndLabelGivenTwice) {
  const WeightedVoxelMap map = mapOf(mixedCloud(6, 100));
  std::vector<LabelledVoxelSums> entries = map.entries();
  entries.push_back(entries.front());
  expectThrows<std::invalid_argument>([&] { WeightedVoxelMap(map.origin(), entries); }, {"twice"});
}

}  // namespace
}  // namespace saw_ndt
