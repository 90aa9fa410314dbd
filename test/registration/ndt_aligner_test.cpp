#include "saw_ndt/registration/ndt_aligner.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "registration/ndt_evaluation.h"
#include "registration/registration_fixtures.h"

namespace saw_ndt {

using namespace internal;

namespace {

NdtTarget cornerMap(const Eigen::Isometry3d& T_map_corner = Eigen::Isometry3d::Identity()) {
  return exactTargetOf(streetCorner(1), T_map_corner);
}

double distance(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.translation() - b.translation()).norm();
}

double angle(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return rotationAngle(a.linear().transpose() * b.linear());
}

TEST(NdtAligner, FindsTheTruePoseFromManyStartsWithAndWithoutWeights) {
  const NdtTarget map = cornerMap();
  const SourcePoints source = sourceOf(streetCorner(2, 1500));
  NdtAligner aligner;
  std::mt19937 random(11);
  for (const bool use_weights : {false, true}) {
    AlignmentOptions options;
    options.use_weights = use_weights;
    for (int trial = 0; trial < 20; ++trial) {
      const AlignmentResult result = aligner.align(map, source, randomPose(random, 0.5, 0.1), options);
      EXPECT_TRUE(result.converged());
      // The noise of 1 cm averages to below a millimetre over thousands of points.
      EXPECT_LT(distance(result.T_map_source, Eigen::Isometry3d::Identity()), 2e-3);
      EXPECT_LT(angle(result.T_map_source, Eigen::Isometry3d::Identity()), 5e-4);
    }
  }
}

TEST(NdtAligner, TheResultIsAMaximumOfTheScore) {
  const NdtTarget map = cornerMap();
  const SourcePoints source = sourceOf(streetCorner(2, 1500));
  NdtAligner aligner;
  AlignmentOptions options;
  std::mt19937 random(12);
  const AlignmentResult result = aligner.align(map, source, randomPose(random, 0.3, 0.05), options);
  NdtEvaluation evaluation;
  evaluation.begin(map, source, options);
  const Evaluation evaluate = evaluation.onMatchingLevels(result.T_map_source);
  const double best = evaluate(result.T_map_source).score;
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Isometry3d beside = result.T_map_source * randomPose(random, 0.01, 0.002);
    EXPECT_LT(evaluate(beside).score, best);
  }
}

TEST(NdtAligner, FindsAPoseMetresAwayWithTheCoarseLevelAlone) {
  const NdtTarget map = cornerMap();
  const SourcePoints source = sourceOf(streetCorner(2, 1500));
  Eigen::Isometry3d guess = Eigen::Isometry3d::Identity();
  guess.translation() = Eigen::Vector3d(1.6, -1.4, 0.2);
  NdtAligner aligner;
  AlignmentOptions options;
  EXPECT_LT(distance(aligner.align(map, source, guess, options).T_map_source, Eigen::Isometry3d::Identity()), 2e-3);
  options.use_coarse_level = false;
  EXPECT_GT(distance(aligner.align(map, source, guess, options).T_map_source, Eigen::Isometry3d::Identity()), 0.1);
}

TEST(NdtAligner, SameBitsForAnyNumberOfThreads) {
  const NdtTarget map = cornerMap();
  const SourcePoints source = sourceOf(streetCorner(2));
  NdtAligner aligner;
  std::mt19937 random(13);
  const Eigen::Isometry3d guess = randomPose(random, 0.5, 0.1);
  for (const Optimizer optimizer : {Optimizer::DAMPED_NEWTON, Optimizer::NEWTON_MORE_THUENTE}) {
    AlignmentOptions options;
    options.optimizer = optimizer;
    options.threads = 1;
    const AlignmentResult one = aligner.align(map, source, guess, options);
    for (const int threads : {2, 4}) {
      options.threads = threads;
      EXPECT_EQ(aligner.align(map, source, guess, options).T_map_source.matrix(), one.T_map_source.matrix());
    }
  }
}

TEST(NdtAligner, TellsTheIterationLimitFromConvergence) {
  const NdtTarget map = cornerMap();
  const SourcePoints source = sourceOf(streetCorner(2, 500));
  std::mt19937 random(14);
  const Eigen::Isometry3d guess = randomPose(random, 0.3, 0.05);
  NdtAligner aligner;
  for (const Optimizer optimizer : {Optimizer::DAMPED_NEWTON, Optimizer::NEWTON_MORE_THUENTE}) {
    AlignmentOptions options;
    options.optimizer = optimizer;
    options.use_coarse_level = false;
    options.neighborhood_search = NeighborhoodSearchMethod::RADIUS;
    options.max_iterations = 1;
    const AlignmentResult result = aligner.align(map, source, guess, options);
    EXPECT_EQ(result.status, AlignmentStatus::ITERATION_LIMIT);
    EXPECT_EQ(result.iterations, 1);
    options.max_iterations = 100;
    EXPECT_EQ(aligner.align(map, source, guess, options).status, AlignmentStatus::CONVERGED);
  }
}

TEST(NdtAligner, WithoutOverlapSourceOrTargetItSaysSo) {
  const NdtTarget map = cornerMap();
  const SourcePoints source = sourceOf(streetCorner(2, 100));
  Eigen::Isometry3d far = Eigen::Isometry3d::Identity();
  far.translation().x() = 5000.0;
  NdtAligner aligner;
  for (const Optimizer optimizer : {Optimizer::DAMPED_NEWTON, Optimizer::NEWTON_MORE_THUENTE}) {
    AlignmentOptions options;
    options.optimizer = optimizer;
    const AlignmentResult result = aligner.align(map, source, far, options);
    EXPECT_EQ(result.status, AlignmentStatus::NO_OVERLAP);
    EXPECT_FALSE(result.converged());
    EXPECT_EQ(result.T_map_source.matrix(), far.matrix());
    EXPECT_EQ(aligner.align(map, {}, far, options).status, AlignmentStatus::NO_SOURCE);
    EXPECT_EQ(aligner.align(NdtTarget(), source, far, options).status, AlignmentStatus::NO_TARGET);
  }
}

TEST(NdtAligner, AMapOfOneVoxelKeepsEveryFigureFinite) {
  pcl::PointCloud<pcl::PointXYZL> cloud;
  std::mt19937 random(15);
  std::uniform_real_distribution<float> uniform(0.1f, 0.9f);
  for (int i = 0; i < 20; ++i) {
    pcl::PointXYZL point;
    point.x = uniform(random);
    point.y = uniform(random);
    point.z = 0.5f;
    point.label = 2;
    cloud.push_back(point);
  }
  const NdtTarget map = exactTargetOf(cloud);
  ASSERT_EQ(map.voxelCount(), 1u);
  NdtAligner aligner;
  const AlignmentResult result = aligner.align(map, sourceOf(cloud), randomPose(random, 0.1, 0.05), {});
  EXPECT_TRUE(result.T_map_source.matrix().allFinite());
  EXPECT_TRUE(std::isfinite(result.likelihood));
  EXPECT_LT(result.T_map_source.translation().norm(), 2.0);
}

TEST(NdtAligner, MillimetresAreKeptInProjectedCoordinates) {
  Eigen::Isometry3d T_map_corner = Eigen::Isometry3d::Identity();
  T_map_corner.translation() = Eigen::Vector3d(500000.0, 4649776.0, 120.0);
  const NdtTarget near_map = cornerMap(), far_map = cornerMap(T_map_corner);
  const SourcePoints source = sourceOf(streetCorner(2, 1500));
  NdtAligner aligner;
  std::mt19937 random(16);
  const Eigen::Isometry3d guess = randomPose(random, 0.5, 0.1);
  const AlignmentResult near_result = aligner.align(near_map, source, guess, {});
  const AlignmentResult far_result = aligner.align(far_map, source, T_map_corner * guess, {});
  EXPECT_TRUE(far_result.converged());
  // A shift by whole voxels changes nothing but the last digits of the pose itself.
  EXPECT_LT(distance(far_result.T_map_source, T_map_corner * near_result.T_map_source), 1e-6);
  EXPECT_LT(angle(far_result.T_map_source, T_map_corner * near_result.T_map_source), 1e-6);
}

TEST(NdtAligner, RefusesOptionsThatDoNotHoldAndNamesThem) {
  const NdtTarget map = cornerMap();
  NdtAligner aligner;
  AlignmentOptions options;
  options.outlier_ratio = 1.0;
  try {
    aligner.align(map, {}, Eigen::Isometry3d::Identity(), options);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("outlier_ratio = 1"), std::string::npos) << error.what();
  }
  Eigen::Isometry3d guess = Eigen::Isometry3d::Identity();
  guess.translation().x() = std::nan("");
  EXPECT_THROW(aligner.align(map, sourceOf(streetCorner(2, 100)), guess, {}), std::invalid_argument);
}

TEST(NdtAligner, DoublesGiveThePoseOfSinglesAndNeedTheirCells) {
  const NdtTarget map = cornerMap();
  const SourcePoints source = sourceOf(streetCorner(2, 1500));
  NdtAligner aligner;
  std::mt19937 random(17);
  const Eigen::Isometry3d guess = randomPose(random, 0.3, 0.05);
  AlignmentOptions exact;
  exact.arithmetic = Arithmetic::DOUBLE;
  EXPECT_LT(distance(aligner.align(map, source, guess, exact).T_map_source,
                     aligner.align(map, source, guess, {}).T_map_source),
            1e-4);
  WeightedMapBuilder builder(1.0);
  addCloud(builder, streetCorner(1), Eigen::Isometry3d::Identity());
  EXPECT_THROW(aligner.align(NdtTarget(builder.build()), source, guess, exact), std::invalid_argument);
}

TEST(NdtAligner, EightAlignmentsToOneTargetAtOnceGiveTheSameBitsAsOneAfterTheOther) {
  const NdtTarget target = cornerMap();
  const SourcePoints source = sourceOf(streetCorner(2, 1500));
  AlignmentOptions options;
  options.threads = 2;
  std::mt19937 random(31);
  std::vector<Eigen::Isometry3d> guesses;
  for (int i = 0; i < 8; ++i) guesses.push_back(randomPose(random, 0.3, 0.05));
  std::vector<AlignmentResult> expected(guesses.size()), found(guesses.size());
  const auto align = [&](std::size_t i) { return NdtAligner().align(target, source, guesses[i], options); };
  for (std::size_t i = 0; i < guesses.size(); ++i) expected[i] = align(i);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < guesses.size(); ++i) threads.emplace_back([&, i] { found[i] = align(i); });
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < guesses.size(); ++i) {
    EXPECT_TRUE(found[i].converged());
    EXPECT_TRUE(found[i].T_map_source.matrix() == expected[i].T_map_source.matrix()) << i;
    EXPECT_EQ(found[i].score, expected[i].score) << i;
  }
}

}  // namespace
}  // namespace saw_ndt
