#include "saw_ndt/map/weighted_map_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <thread>
#include <vector>

#include "expect_throws.h"
#include "map_fixtures.h"
#include "saw_ndt/pcl/cloud_view.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

using LabelledCloud = pcl::PointCloud<pcl::PointXYZL>;

Eigen::Isometry3d poseOf(int scan) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translate(Eigen::Vector3d(0.7 * scan, -0.1 * scan, 0.01 * scan));
  T.rotate(Eigen::AngleAxisd(0.05 * scan, Eigen::Vector3d(0.1, 0.2, 1.0).normalized()));
  return T;
}

std::string savedBytes(const WeightedVoxelMap& map) {
  const TemporaryFolder folder;
  map.save((folder.path() / "a.map").string());
  return contentOf(folder.path() / "a.map");
}

struct Scan {
  LabelledCloud cloud;
  Eigen::Isometry3d T_map_cloud;
};

std::vector<Scan> drive() {
  std::vector<Scan> scans;
  for (int i = 0; i < 9; ++i) scans.push_back({mixedCloud(static_cast<unsigned>(i), 1500), poseOf(i)});
  return scans;
}

WeightedMapBuilder builderOf(const std::vector<Scan>& scans) {
  WeightedMapBuilder builder(0.8);
  for (const Scan& scan : scans) addCloud(builder, scan.cloud, scan.T_map_cloud);
  return builder;
}

void expectEqualLevels(const NdtLevel& a, const NdtLevel& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const VoxelStatistics va = a.voxel(i), vb = b.voxel(i);
    ASSERT_EQ(va.voxel, vb.voxel);
    ASSERT_EQ(va.point_count, vb.point_count);
    ASSERT_EQ(va.mean_from_centre, vb.mean_from_centre);
    ASSERT_EQ(va.inverse_covariance, vb.inverse_covariance);
    ASSERT_EQ(va.mean_confidence, vb.mean_confidence);
    ASSERT_EQ(va.structure_class, vb.structure_class);
    ASSERT_EQ(va.weight, vb.weight);
  }
}

TEST(WeightedMapBuilder, AnyOrderOfCloudsAndPointsGivesTheSameBytes) {
  std::vector<Scan> scans = drive();
  const std::string expected = savedBytes(builderOf(scans).build());
  std::mt19937 random(1);
  for (int trial = 0; trial < 5; ++trial) {
    std::shuffle(scans.begin(), scans.end(), random);
    for (Scan& scan : scans) std::shuffle(scan.cloud.begin(), scan.cloud.end(), random);
    EXPECT_TRUE(savedBytes(builderOf(scans).build()) == expected);
  }
}

TEST(WeightedMapBuilder, MergedPartsGiveTheSameBytes) {
  const std::vector<Scan> scans = drive();
  const std::string expected = savedBytes(builderOf(scans).build());
  WeightedMapBuilder merged(0.8);
  merged.merge(WeightedMapBuilder(0.8));
  merged.merge(builderOf({scans.begin() + 6, scans.end()}));
  merged.merge(builderOf({scans.begin(), scans.begin() + 2}));
  merged.merge(WeightedMapBuilder(0.8));
  merged.merge(builderOf({scans.begin() + 2, scans.begin() + 6}));
  EXPECT_TRUE(savedBytes(merged.build()) == expected);
}

TEST(WeightedMapBuilder, AnyNumberOfThreadsGivesTheSameBytes) {
  const std::vector<Scan> scans = drive();
  const std::string expected = savedBytes(builderOf(scans).build());
  for (const std::size_t thread_count : {1U, 2U, 4U}) {
    std::vector<WeightedMapBuilder> parts(thread_count, WeightedMapBuilder(0.8));
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < thread_count; ++t) {
      threads.emplace_back([&, t] {
        for (std::size_t i = t; i < scans.size(); i += thread_count) {
          addCloud(parts[t], scans[i].cloud, scans[i].T_map_cloud);
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    WeightedMapBuilder merged(0.8);
    for (const WeightedMapBuilder& part : parts) merged.merge(part);
    EXPECT_TRUE(savedBytes(merged.build()) == expected);
  }
}

TEST(WeightedMapBuilder, CountsWhatItWasGiven) {
  LabelledCloud cloud = mixedCloud(1, 100);
  cloud[3].x = std::numeric_limits<float>::quiet_NaN();
  cloud[4].z = std::numeric_limits<float>::infinity();
  cloud[5].y = 1e30F;
  WeightedMapBuilder builder(1.0);
  addCloud(builder, cloud, Eigen::Isometry3d::Identity());
  addCloud(builder, LabelledCloud(), Eigen::Isometry3d::Identity());
  const WeightedVoxelMap map = builder.build();
  EXPECT_EQ(map.origin().point_count, 97U);
  EXPECT_EQ(map.origin().scan_count, 2U);
  EXPECT_TRUE(map.labelled());
  std::uint64_t summed = 0;
  for (const LabelledVoxelSums& entry : map.entries()) summed += entry.sums.count;
  EXPECT_EQ(summed, 97U);
}

TEST(WeightedMapBuilder, MemoryGrowsWithVoxelsNotWithPoints) {
  const Scan scan{mixedCloud(1, 3000), poseOf(1)};
  WeightedMapBuilder builder(1.0);
  addCloud(builder, scan.cloud, scan.T_map_cloud);
  const std::size_t entry_count = builder.build().entries().size();
  EXPECT_LT(entry_count, 3000U);
  for (int i = 0; i < 50; ++i) addCloud(builder, scan.cloud, scan.T_map_cloud);
  const WeightedVoxelMap map = builder.build();
  EXPECT_EQ(map.entries().size(), entry_count);
  EXPECT_EQ(map.origin().point_count, 51U * 3000U);
}

TEST(WeightedMapBuilder, LabelledAndUnlabelledCloudsDoNotMix) {
  const LabelledCloud labelled = mixedCloud(1, 50);
  const pcl::PointCloud<pcl::PointXYZ> plain = withoutLabels(labelled);
  const Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  WeightedMapBuilder with(1.0), without(1.0);
  addCloud(with, labelled, T);
  addCloud(without, plain, T);
  EXPECT_TRUE(with.build().labelled());
  EXPECT_FALSE(without.build().labelled());
  expectThrows<std::invalid_argument>([&] { addCloud(with, plain, T); }, {"labelled or unlabelled"});
  expectThrows<std::invalid_argument>([&] { addCloud(without, labelled, T); }, {"labelled or unlabelled"});
  expectThrows<std::invalid_argument>([&] { with.merge(without); }, {"labelled or unlabelled"});
  EXPECT_EQ(with.build().origin().scan_count, 1U);
  EXPECT_EQ(with.build().origin().point_count, 50U);
}

TEST(WeightedMapBuilder, RefusesWhatDoesNotHoldAndStaysAsItWas) {
  WeightedMapBuilder builder(1.0);
  LabelledCloud bad = mixedCloud(1, 50);
  bad[49].label = 3;
  const Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  expectThrows<std::invalid_argument>([&] { addCloud(builder, bad, T); }, {"label = 3"});
  Eigen::Isometry3d not_finite = T;
  not_finite.translation().x() = std::nan("");
  expectThrows<std::invalid_argument>([&] { addCloud(builder, mixedCloud(1, 50), not_finite); }, {"T_map_cloud"});
  EXPECT_EQ(builder.build().origin().scan_count, 0U);
  EXPECT_TRUE(builder.build().entries().empty());
  expectThrows<std::invalid_argument>([&] { builder.merge(WeightedMapBuilder(0.5)); }, {"resolution_m = 0.5"});
  for (const double resolution_m : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    expectThrows<std::invalid_argument>([&] { WeightedMapBuilder{resolution_m}; }, {"resolution_m"});
  }
}

TEST(WeightedMapBuilder, ProjectedCoordinatesKeepTheirMillimetres) {
  const LabelledCloud cloud = mixedCloud(5, 6000);
  const Eigen::Isometry3d T_local = poseOf(3);
  WeightedMapBuilder at_origin(1.0);
  addCloud(at_origin, cloud, T_local);
  const WeightedVoxelMap expected = at_origin.build();
  // Multiples of the coarse voxel's 3 m, so that the voxels are the same ones.
  const VoxelCoordinate offset(500001, 4999998, -300);
  Eigen::Isometry3d T_far = T_local;
  T_far.translation() += offset.cast<double>();
  WeightedMapBuilder far(1.0);
  addCloud(far, cloud, T_far);
  const WeightedVoxelMap map = far.build();
  for (const bool coarse : {false, true}) {
    const NdtLevel& near_level = coarse ? expected.coarse() : expected.fine();
    const NdtLevel& far_level = coarse ? map.coarse() : map.fine();
    const VoxelCoordinate voxel_offset = coarse ? VoxelCoordinate(offset / 3) : offset;
    ASSERT_EQ(far_level.size(), near_level.size());
    for (std::size_t i = 0; i < near_level.size(); ++i) {
      const VoxelStatistics near_voxel = near_level.voxel(i);
      const std::int32_t found = far_level.index().find(near_voxel.voxel + voxel_offset);
      ASSERT_NE(found, VoxelIndex::kNone);
      const VoxelStatistics far_voxel = far_level.voxel(static_cast<std::size_t>(found));
      ASSERT_EQ(far_voxel.point_count, near_voxel.point_count);
      ASSERT_EQ(far_voxel.structure_class, near_voxel.structure_class);
      ASSERT_NEAR(far_voxel.weight, near_voxel.weight, 1e-12);
      const double resolution_m = near_level.resolution();
      ASSERT_LE(
          (far_voxel.mean(resolution_m) - offset.cast<double>() - near_voxel.mean(resolution_m)).cwiseAbs().maxCoeff(),
          1e-6);
      ASSERT_LE((far_voxel.covariance - near_voxel.covariance).cwiseAbs().maxCoeff(), 1e-6);
    }
  }
}

TEST(WeightedVoxelMap, ReweightedEqualsBuildingWithThoseOptions) {
  const WeightedMapBuilder builder = builderOf(drive());
  VoxelWeighting weighting;
  weighting.confidence = ConfidenceOptions::paper();
  weighting.linear_alpha = 0.3;
  weighting.min_points_per_voxel = 10;
  weighting.min_eigenvalue_ratio = 0.05;
  weighting.coarse_factor = 2;
  const WeightedVoxelMap built = builder.build(weighting);
  const WeightedVoxelMap reweighted = builder.build().reweighted(weighting);
  expectEqualLevels(reweighted.fine(), built.fine());
  expectEqualLevels(reweighted.coarse(), built.coarse());
  EXPECT_NE(builder.build().fine().size(), built.fine().size());
  EXPECT_TRUE(savedBytes(reweighted) == savedBytes(builder.build()));
  weighting.coarse_factor = 0;
  expectThrows<std::invalid_argument>([&] { built.reweighted(weighting); }, {"coarse_factor = 0"});
}

TEST(WeightedVoxelMap, UniformConfidencesEqualAnUnlabelledMapBitForBit) {
  VoxelWeighting uniform;
  uniform.confidence = ConfidenceOptions::uniform();
  const LabelledCloud cloud = mixedCloud(6, 8000);
  const WeightedVoxelMap labelled = mapOf(cloud, 1.0, uniform);
  const WeightedVoxelMap unlabelled = mapOf(withoutLabels(cloud));
  expectEqualLevels(labelled.fine(), unlabelled.fine());
  expectEqualLevels(labelled.coarse(), unlabelled.coarse());
  EXPECT_GT(labelled.entries().size(), unlabelled.entries().size());
}

TEST(WeightedVoxelMap, RefusesAVoxelAndLabelGivenTwice) {
  const WeightedVoxelMap map = mapOf(mixedCloud(6, 100));
  std::vector<LabelledVoxelSums> entries = map.entries();
  entries.push_back(entries.front());
  expectThrows<std::invalid_argument>([&] { WeightedVoxelMap(map.origin(), entries); }, {"twice"});
}

}  // namespace
}  // namespace saw_ndt
