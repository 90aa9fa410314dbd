#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "map/level_plan.h"
#include "map_fixtures.h"
#include "temporary_folder.h"

namespace saw_ndt {

using namespace internal;

namespace {

VoxelWeighting adaptive(double finest_m, double coarsest_m) {
  VoxelWeighting weighting;
  weighting.sizes.finest_m = finest_m;
  weighting.sizes.coarsest_m = coarsest_m;
  return weighting;
}

std::vector<double> edges(double resolution_m, const VoxelWeighting& weighting) {
  MapOrigin origin;
  origin.resolution_m = resolution_m;
  origin.scan_count = 10;
  std::vector<double> edges_m;
  for (const LevelPlan& level : planTarget(origin, weighting).levels) edges_m.push_back(level.resolution_m);
  return edges_m;
}

/// Scans of the same scene; each has points of its own.
WeightedVoxelMap mapOfScans(int count, double resolution_m) {
  WeightedMapBuilder builder(resolution_m);
  for (int scan = 0; scan < count; ++scan) {
    addCloud(builder, mixedCloud(static_cast<unsigned>(scan), 6000), Eigen::Isometry3d::Identity());
  }
  return std::move(builder).build();
}

/// The map entry of each voxel that most scans met, by its label.
std::uint32_t scansThatMet(const WeightedVoxelMap& map, const VoxelCoordinate& voxel, int factor) {
  std::uint32_t most = 0;
  for (const LabelledVoxelSums& entry : map.entries()) {
    const auto inside = [&](int axis) {
      return entry.voxel[axis] >= voxel[axis] * factor && entry.voxel[axis] < (voxel[axis] + 1) * factor;
    };
    if (inside(0) && inside(1) && inside(2)) most = std::max(most, entry.scan_count);
  }
  return most;
}

TEST(VoxelSizes, AreWholeVoxelsOfTheMapAndEachTwiceTheOneBefore) {
  EXPECT_EQ(edges(0.5, {}), std::vector<double>({0.5}));
  EXPECT_EQ(edges(0.5, adaptive(1.0, 0.0)), std::vector<double>({1.0}));
  EXPECT_EQ(edges(0.5, adaptive(0.5, 4.0)), std::vector<double>({0.5, 1.0, 2.0, 4.0}));
  EXPECT_EQ(edges(0.25, adaptive(0.5, 2.0)), std::vector<double>({0.5, 1.0, 2.0}));
  EXPECT_EQ(edges(1.0, adaptive(0.5, 4.0)), std::vector<double>({1.0, 2.0, 4.0}));
  EXPECT_EQ(edges(5.0, adaptive(0.5, 4.0)), std::vector<double>({5.0}));
  EXPECT_EQ(edges(0.7, adaptive(1.0, 0.0)), std::vector<double>({0.7}));
  // Sixteen voxels of the map at most.
  EXPECT_EQ(edges(0.125, adaptive(0.5, 4.0)), std::vector<double>({0.5, 1.0, 2.0}));
}

TEST(VoxelSizes, ALargerVoxelIsThatOfAMapOfSuchVoxels) {
  const pcl::PointCloud<pcl::PointXYZL> cloud = mixedCloud(1, 40000);
  const NdtTarget direct(mapOf(cloud, 1.0)), derived(mapOf(cloud, 0.5), adaptive(1.0, 0.0));
  EXPECT_EQ(derived.resolution(), 1.0);
  ASSERT_EQ(derived.fine().index().voxels(), direct.fine().index().voxels());
  const std::vector<Eigen::Vector3d> means = derived.means(), expected = direct.means();
  // A step of a map of 0.5 m is half as long: positions are rounded by 7.6 and 3.8 micrometres at most.
  for (std::size_t i = 0; i < means.size(); ++i) EXPECT_LT((means[i] - expected[i]).cwiseAbs().maxCoeff(), 1.2e-5);
}

TEST(VoxelSizes, AVoxelBeforeTheLastLevelWasMetByTwoScans) {
  const WeightedVoxelMap map = mapOfScans(3, 0.5);
  VoxelWeighting weighting = adaptive(0.5, 2.0);
  weighting.min_points_per_voxel = 3;
  const NdtTarget target(map, weighting, 1);
  ASSERT_EQ(target.levels().size(), 3U);
  std::size_t left_out = 0;
  for (std::size_t level = 0; level < 2; ++level) {
    const int factor = 1 << level;
    for (const VoxelCoordinate& voxel : target.levels()[level].index().voxels()) {
      EXPECT_GE(scansThatMet(map, voxel, factor), 2U);
    }
  }
  for (const VoxelStatistics& voxel : map.statistics(weighting)) {
    const bool kept = target.fine().index().find(voxel.voxel) != VoxelIndex::kNone;
    EXPECT_EQ(kept, scansThatMet(map, voxel.voxel, 1) >= 2U);
    left_out += kept ? 0 : 1;
  }
  EXPECT_GT(left_out, 10U);
  // One scan has no better, and an old file does not tell.
  const WeightedVoxelMap of_one = mapOfScans(1, 0.5);
  EXPECT_EQ(NdtTarget(of_one, weighting).fine().size(), of_one.voxelCount(weighting));
  std::vector<LabelledVoxelSums> untold = map.entries();
  for (LabelledVoxelSums& entry : untold) entry.scan_count = 0;
  EXPECT_EQ(NdtTarget({map.origin(), untold}, weighting).fine().size(), map.voxelCount(weighting));
}

TEST(VoxelSizes, ALargerVoxelIsNoLine) {
  WeightedMapBuilder builder(0.5);
  pcl::PointCloud<pcl::PointXYZL> ring, face;
  for (int i = 0; i < 400; ++i) {
    pcl::PointXYZL point;
    point.label = 2;
    const float along = 0.005F * static_cast<float>(i);
    point.getVector3fMap() << along, 0.3F + 0.01F * std::sin(40.0F * along), 0.3F;
    ring.push_back(point);
    point.getVector3fMap() << 10.0F + along, 2.0F * std::fmod(0.618F * static_cast<float>(i), 1.0F), 0.3F;
    face.push_back(point);
  }
  for (int scan = 0; scan < 2; ++scan) {
    addCloud(builder, ring, Eigen::Isometry3d::Identity());
    addCloud(builder, face, Eigen::Isometry3d::Identity());
  }
  const NdtTarget target(builder.build(), adaptive(0.5, 2.0));
  EXPECT_NE(target.fine().find({0.3, 0.3, 0.3}), VoxelIndex::kNone);
  for (std::size_t level = 1; level < 3; ++level) {
    EXPECT_EQ(target.levels()[level].find({0.3, 0.3, 0.3}), VoxelIndex::kNone);
    EXPECT_NE(target.levels()[level].find({10.3, 0.3, 0.3}), VoxelIndex::kNone);
  }
}

TEST(VoxelSizes, LoadedTileByTileTheTargetIsTheSameBitForBit) {
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "a.map").string();
  const WeightedVoxelMap map = mapOfScans(4, 0.25);
  map.save(path);
  VoxelWeighting weighting = adaptive(0.5, 2.0);
  weighting.unbounded_ground = true;
  weighting.coarse_factor = 6;
  const NdtTarget expected(map, weighting, 1);
  for (const int threads : {1, 2, 4}) {
    const NdtTarget loaded = NdtTarget::load(path, weighting, threads), made(map, weighting, threads);
    for (const NdtTarget* target : {&loaded, &made}) {
      ASSERT_EQ(target->levels().size(), 3U);
      for (std::size_t i = 0; i < 3; ++i) expectEqualLevels(target->levels()[i], expected.levels()[i]);
      expectEqualLevels(target->coarse(), expected.coarse());
    }
    EXPECT_EQ(loaded.coarse().resolution(), 3.0);
  }
}

TEST(UnboundedGround, HoldsAlongItsNormalAlone) {
  const WeightedVoxelMap map = mapOfScans(2, 1.0);
  VoxelWeighting bounded, unbounded;
  unbounded.unbounded_ground = true;
  const NdtTarget before(map, bounded, 1, CellPrecision::SINGLE_AND_DOUBLE);
  const NdtTarget after(map, unbounded, 1, CellPrecision::SINGLE_AND_DOUBLE);
  expectEqualLevels(before.coarse(), after.coarse());
  const auto informationOf = [](const NdtCell& cell) {
    const double* c = cell.inverse_covariance;
    Eigen::Matrix3d information;
    information << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(information).eigenvalues().eval();
  };
  std::size_t ground = 0, others = 0;
  for (const VoxelStatistics& voxel : map.statistics(bounded)) {
    const auto number = static_cast<std::size_t>(before.fine().index().find(voxel.voxel));
    const Eigen::Vector3d was = informationOf(before.fine().cells()[number]);
    const Eigen::Vector3d is = informationOf(after.fine().cells()[number]);
    // Pure ground, and nothing of ground, by the mean of the confidences.
    if (voxel.mean_confidence == bounded.confidence.ground) {
      if (is == was) continue;  // not flat
      EXPECT_NEAR(is[2] / was[2], 1.0, 1e-9);
      EXPECT_NEAR(is[1] / was[1], 0.01, 1e-9);
      EXPECT_NEAR(is[0] / was[0], 0.01, 1e-9);
      ++ground;
    } else if (voxel.mean_confidence == bounded.confidence.non_ground) {
      EXPECT_TRUE(is == was);
      ++others;
    }
  }
  EXPECT_GT(ground, 100U);
  EXPECT_GT(others, 50U);
}

}  // namespace
}  // namespace saw_ndt
