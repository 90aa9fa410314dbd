#include "registration/likelihoods.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "map/map_fixtures.h"
#include "registration/registration_fixtures.h"
#include "registration/score_function.h"

namespace saw_ndt {

using namespace internal;

namespace {

/// Every point against every voxel: a voxel counts that is the point's own or shares a face with it.
Likelihoods byBruteForce(const WeightedVoxelMap& map, const SourcePoints& source, const Eigen::Isometry3d& T_map_source,
                         double outlier_ratio) {
  const std::vector<VoxelStatistics> voxels = map.statistics();
  const ScoreParameters score = scoreParameters(ScoreFunction::MAGNUSSON, outlier_ratio, map.resolution());
  double all = 0.0, non_ground = 0.0, best_sum = 0.0;
  int non_ground_points = 0, matched_points = 0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const Eigen::Vector3d p = T_map_source * Eigen::Vector3d(source.x[i], source.y[i], source.z[i]);
    const VoxelCoordinate own = (p / map.resolution()).array().floor().matrix().cast<int>();
    double best = 0.0, total = 0.0;
    bool matched = false;
    for (const VoxelStatistics& voxel : voxels) {
      if ((voxel.voxel - own).cwiseAbs().sum() > 1) continue;
      const Eigen::Vector3d q = p - voxel.mean(map.resolution());
      const double pair = score.amplitude * std::exp(-0.5 * score.d2 * q.dot(voxel.inverse_covariance * q));
      total += pair;
      best = std::max(best, pair);
      matched = true;
    }
    all += total;
    best_sum += best;
    matched_points += matched ? 1 : 0;
    if (source.label[i] == static_cast<std::uint8_t>(StructuralLabel::GROUND)) continue;
    non_ground += total;
    ++non_ground_points;
  }
  return {all / static_cast<double>(source.size()), non_ground / std::max(1, non_ground_points),
          best_sum / std::max(1, matched_points)};
}

TEST(Likelihoods, EqualBruteForce) {
  const WeightedVoxelMap map = mapOf(streetCorner(1, 1500));
  const NdtTarget target(map);
  std::mt19937 random(2);
  for (const double outlier_ratio : {0.3, 0.55}) {
    for (const double offset_m : {0.0, 0.2, 4.0}) {
      for (const bool labelled : {true, false}) {
        const SourcePoints source = sourceOf(streetCorner(3, 60), labelled);
        const Eigen::Isometry3d T = randomPose(random, offset_m, 0.1 * offset_m);
        const Likelihoods expected = byBruteForce(map, source, T, outlier_ratio);
        for (const int threads : {1, 3}) {
          const Likelihoods got = evaluateLikelihoods(target.fine(), source, T, outlier_ratio, threads);
          // Single precision: positions round by up to 5e-7 m, 5e-5 of the standard deviations of 1 cm.
          EXPECT_NEAR(got.unweighted, expected.unweighted, 1e-5);
          EXPECT_NEAR(got.non_ground, expected.non_ground, 1e-5);
          EXPECT_NEAR(got.nearest_voxel, expected.nearest_voxel, 1e-5);
        }
        if (!labelled) {
          EXPECT_DOUBLE_EQ(expected.unweighted, expected.non_ground);
        }
      }
    }
  }
}

TEST(Likelihoods, WeightsDoNotChangeThem) {
  const WeightedVoxelMap map = mapOf(streetCorner(1));
  VoxelWeighting other;
  other.linear_alpha = 0.1;
  other.planar_alpha = 3.0;
  other.confidence.ground = 0.1;
  const SourcePoints source = sourceOf(streetCorner(2));
  const Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  const Likelihoods a = evaluateLikelihoods(NdtTarget(map).fine(), source, T, 0.55, 1);
  const Likelihoods b = evaluateLikelihoods(NdtTarget(map, other).fine(), source, T, 0.55, 1);
  EXPECT_EQ(a.unweighted, b.unweighted);
  EXPECT_EQ(a.non_ground, b.non_ground);
  EXPECT_EQ(a.nearest_voxel, b.nearest_voxel);
}

TEST(Likelihoods, AreZeroWhereThereIsNothingToMatch) {
  const NdtTarget map(mapOf(streetCorner(1)));
  const auto expectZero = [](const Likelihoods& likelihoods) {
    EXPECT_EQ(likelihoods.unweighted, 0.0);
    EXPECT_EQ(likelihoods.non_ground, 0.0);
    EXPECT_EQ(likelihoods.nearest_voxel, 0.0);
  };
  Eigen::Isometry3d far = Eigen::Isometry3d::Identity();
  far.translation().x() = 1000.0;
  expectZero(evaluateLikelihoods(map.fine(), sourceOf(streetCorner(2)), far, 0.55, 2));
  far.translation().x() = 1e30;
  expectZero(evaluateLikelihoods(map.fine(), sourceOf(streetCorner(2)), far, 0.55, 2));
  expectZero(evaluateLikelihoods(map.fine(), SourcePoints(), Eigen::Isometry3d::Identity(), 0.55, 2));
  expectZero(
      evaluateLikelihoods(internal::NdtLevel(), sourceOf(streetCorner(2)), Eigen::Isometry3d::Identity(), 0.55, 2));
}

}  // namespace
}  // namespace saw_ndt
