#include "registration/ndt_objective.h"

#include <gtest/gtest.h>

#include "expect_throws.h"
#include "registration/registration_fixtures.h"
#include "temporary_folder.h"

namespace saw_ndt {

using namespace internal;

namespace {

Eigen::Isometry3d moved(const Eigen::Isometry3d& T, const Vector6d& step) {
  Eigen::Isometry3d result = T;
  result.translation() += step.head<3>();
  result.linear() = rotationFromVector(step.tail<3>()) * T.linear();
  return result;
}

struct Case {
  NeighborhoodSearchMethod method;
  bool weighted;
};

class NdtObjectiveDerivatives : public testing::TestWithParam<Case> {};

// Central difference of fourth order: its error falls with the fourth power of the step, so that voxels 1 cm thick
// leave it below 1e-8 of the value.
constexpr double kStep = 1e-5;
template <typename Function>
auto centralDifference(const Function& f) -> decltype(f(0.0)) {
  const auto far_right = f(2.0 * kStep), right = f(kStep), left = f(-kStep), far_left = f(-2.0 * kStep);
  return (8.0 * (right - left) - (far_right - far_left)) / (12.0 * kStep);
}

// Analytic derivatives against central differences; the steps of 1e-5 move no point across an event.
TEST_P(NdtObjectiveDerivatives, AgreeWithCentralDifferences) {
  const NdtTarget map = exactTargetOf(streetCorner(1));
  const SourcePoints all = sourceOf(streetCorner(2, 300));
  const PairWeighting weighting{GetParam().weighted, 0.1, map.weighting().confidence};
  const NdtObjective objective(map.fine(), GetParam().method, scoreParameters(ScoreFunction::MAGNUSSON, 0.55, 1.0),
                               weighting);
  NdtObjective::Workspace workspace;
  std::mt19937 random(3);
  for (int trial = 0; trial < 5; ++trial) {
    const Eigen::Isometry3d T = randomPose(random, 0.3, 0.1);
    const SourcePoints source = awayFromEvents(all, T, map.fine());
    ASSERT_GT(source.size(), 300u);
    const NdtDerivatives at = objective.evaluate(source, T, 1, workspace);
    Vector6d gradient;
    Matrix6d hessian;
    for (int i = 0; i < 6; ++i) {
      const auto moved_to = [&](double step) {
        return objective.evaluate(source, moved(T, step * Vector6d::Unit(i)), 1, workspace);
      };
      gradient[i] = centralDifference([&](double step) { return moved_to(step).score; });
      // The gradient is taken about the moved pose. Carried back to this one, a turn w adds to the turn already made:
      // dexp(w) = I + [w]x / 2 to first order.
      hessian.col(i) = centralDifference([&](double step) -> Vector6d {
        Matrix6d back = Matrix6d::Identity();
        if (i >= 3) back.bottomRightCorner<3, 3>() += 0.5 * skewSymmetric(step * Eigen::Vector3d::Unit(i - 3));
        return back.transpose() * moved_to(step).gradient();
      });
    }
    EXPECT_LT((at.gradient() - gradient).norm(), 1e-6 * gradient.norm());
    EXPECT_LT((at.hessian() - hessian).norm(), 1e-6 * hessian.norm());
  }
}

TEST_P(NdtObjectiveDerivatives, InEulerAnglesAgreeWithCentralDifferences) {
  const NdtTarget map = exactTargetOf(streetCorner(1));
  const SourcePoints all = sourceOf(streetCorner(2, 300));
  const PairWeighting weighting{GetParam().weighted, 0.1, map.weighting().confidence};
  const NdtObjective objective(map.fine(), GetParam().method, scoreParameters(ScoreFunction::PAPER, 0.55, 1.0),
                               weighting);
  NdtObjective::Workspace workspace;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-0.2, 0.2);
  const auto transformOf = [](const Vector6d& x) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() = x.head<3>();
    T.linear() = rotationFromEuler(x.tail<3>());
    return T;
  };
  for (int trial = 0; trial < 5; ++trial) {
    Vector6d x;
    for (double& value : x) value = uniform(random);
    const SourcePoints source = awayFromEvents(all, transformOf(x), map.fine());
    const auto evaluate = [&](const Vector6d& pose) {
      return eulerDerivatives(objective.evaluate(source, transformOf(pose), 1, workspace), pose.tail<3>());
    };
    const EulerDerivatives at = evaluate(x);
    Vector6d gradient;
    Matrix6d hessian;
    for (int i = 0; i < 6; ++i) {
      const auto moved_to = [&](double step) { return evaluate(x + step * Vector6d::Unit(i)); };
      gradient[i] = centralDifference([&](double step) { return moved_to(step).score; });
      hessian.col(i) = centralDifference([&](double step) -> Vector6d { return moved_to(step).gradient; });
    }
    EXPECT_LT((at.gradient - gradient).norm(), 1e-6 * gradient.norm());
    EXPECT_LT((at.hessian - hessian).norm(), 1e-6 * hessian.norm());
  }
}

INSTANTIATE_TEST_SUITE_P(
    EveryModeWithAndWithoutWeights, NdtObjectiveDerivatives,
    testing::Values(Case{NeighborhoodSearchMethod::DIRECT1, false}, Case{NeighborhoodSearchMethod::DIRECT1, true},
                    Case{NeighborhoodSearchMethod::DIRECT3, false}, Case{NeighborhoodSearchMethod::DIRECT3, true},
                    Case{NeighborhoodSearchMethod::DIRECT7, false}, Case{NeighborhoodSearchMethod::DIRECT7, true},
                    Case{NeighborhoodSearchMethod::DIRECT26, false}, Case{NeighborhoodSearchMethod::DIRECT26, true},
                    Case{NeighborhoodSearchMethod::RADIUS, false}, Case{NeighborhoodSearchMethod::RADIUS, true}));

TEST(NdtObjective, EveryModeMeetsThePairsThatABruteForceSearchMeets) {
  const NdtTarget map = exactTargetOf(streetCorner(1));
  const SourcePoints source = sourceOf(streetCorner(5, 500));
  std::mt19937 random(6);
  const Eigen::Isometry3d T = randomPose(random, 0.5, 0.2);
  const internal::NdtLevel& level = map.fine();
  const std::vector<VoxelCoordinate> voxels = level.index().voxels();
  const std::vector<Eigen::Vector3d> means = level.means();
  std::size_t direct1 = 0, direct3 = 0, direct7 = 0, direct26 = 0, radius = 0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const Eigen::Vector3d p = T * Eigen::Vector3d(source.x[i], source.y[i], source.z[i]);
    const VoxelCoordinate voxel = p.array().floor().matrix().cast<int>();
    for (std::size_t v = 0; v < level.size(); ++v) {
      const VoxelCoordinate difference = (voxels[v] - voxel).cwiseAbs();
      direct1 += difference.maxCoeff() == 0;
      direct3 += difference.sum() <= 1 && difference.z() == difference.sum();
      direct7 += difference.sum() <= 1;
      direct26 += difference.maxCoeff() <= 1;
      radius += (p - means[v]).norm() <= 1.0;
    }
  }
  NdtObjective::Workspace workspace;
  const auto pairs = [&](NeighborhoodSearchMethod method) {
    return NdtObjective(level, method, {}, {}).evaluate(source, T, 1, workspace).pair_count;
  };
  EXPECT_EQ(pairs(NeighborhoodSearchMethod::DIRECT1), direct1);
  EXPECT_EQ(pairs(NeighborhoodSearchMethod::DIRECT3), direct3);
  EXPECT_EQ(pairs(NeighborhoodSearchMethod::DIRECT7), direct7);
  EXPECT_EQ(pairs(NeighborhoodSearchMethod::DIRECT26), direct26);
  EXPECT_EQ(pairs(NeighborhoodSearchMethod::RADIUS), radius);
}

TEST(NdtObjective, SameBitsForAnyNumberOfThreads) {
  const NdtTarget map = exactTargetOf(streetCorner(1));
  const SourcePoints source = sourceOf(streetCorner(2));
  const NdtObjective objective(map.fine(), NeighborhoodSearchMethod::DIRECT7, {}, {true, 0.1, {}});
  NdtObjective::Workspace workspace;
  std::mt19937 random(7);
  const Eigen::Isometry3d T = randomPose(random, 0.2, 0.05);
  const NdtDerivatives one = objective.evaluate(source, T, 1, workspace);
  for (const int threads : {2, 3, 4}) {
    const NdtDerivatives many = objective.evaluate(source, T, threads, workspace);
    EXPECT_EQ(one.score, many.score);
    EXPECT_EQ(one.gradient(), many.gradient());
    EXPECT_EQ(one.hessian(), many.hessian());
  }
}

TEST(NdtObjective, CompatibilityOfPureOppositeAndMixedVoxels) {
  const PairWeighting weighting{true, 0.1, ConfidenceOptions::paper()};
  EXPECT_DOUBLE_EQ(compatibility(0.5, 0.5, weighting), 1.0);
  EXPECT_DOUBLE_EQ(compatibility(1.0, 1.0, weighting), 1.0);
  EXPECT_DOUBLE_EQ(compatibility(1.0, 0.5, weighting), 0.1);
  EXPECT_DOUBLE_EQ(compatibility(0.5, 1.0, weighting), 0.1);
  EXPECT_DOUBLE_EQ(compatibility(1.0, 0.8, weighting), 1.0 - 0.9 * 0.4);
}

// One source point half a standard deviation from the mean of a planar voxel with two ground and six non-ground points:
// s_bar = (2 * 0.5 + 6 * 1.0) / 8 = 0.875, alpha = 1.25, eta = 1 - 0.9 * 0.125 / 0.5 = 0.775 for a non-ground point.
TEST(NdtObjective, WeightOfAPairIsWhatEquationOneSays) {
  pcl::PointCloud<pcl::PointXYZL> target;
  int i = 0;
  for (const float x : {0.25f, 0.75f}) {
    for (const float y : {0.25f, 0.75f}) {
      for (const float z : {0.4375f, 0.5625f}) {
        pcl::PointXYZL point;
        point.x = x;
        point.y = y;
        point.z = z;
        point.label = i++ < 2 ? 1 : 2;
        target.push_back(point);
      }
    }
  }
  VoxelWeighting weighting;
  weighting.confidence = ConfidenceOptions::paper();
  const NdtTarget map = exactTargetOf(target, Eigen::Isometry3d::Identity(), weighting);
  ASSERT_EQ(map.fine().size(), 1u);
  SourcePoints source;
  source.labelled = true;
  source.add(0.5f, 0.5f, 0.53125f, StructuralLabel::NON_GROUND);
  NdtObjective::Workspace workspace;
  const NdtObjective objective(map.fine(), NeighborhoodSearchMethod::DIRECT1, {1.0, 1.0},
                               {true, 0.1, ConfidenceOptions::paper()});
  // Covariance along z: 8 * 0.0625^2 / 7.
  const double mahalanobis = 0.03125 * 0.03125 / (8.0 * 0.0625 * 0.0625 / 7.0);
  const double W = 1.0 * (0.875 * 1.25) * 0.775;
  EXPECT_NEAR(objective.evaluate(source, Eigen::Isometry3d::Identity(), 1, workspace).score,
              W * std::exp(-0.5 * mahalanobis), 1e-12);
}

TEST(NdtObjective, FarFromTheOriginNothingIsLost) {
  pcl::PointCloud<pcl::PointXYZL> cloud = streetCorner(1);
  Eigen::Isometry3d shift = Eigen::Isometry3d::Identity();
  shift.translation() = Eigen::Vector3d(500000.0, 5000000.0, -300.0);
  const NdtTarget near_map = exactTargetOf(cloud), far_map = exactTargetOf(cloud, shift);
  const SourcePoints source = sourceOf(streetCorner(2, 500));
  std::mt19937 random(8);
  const Eigen::Isometry3d T = randomPose(random, 0.2, 0.05);
  NdtObjective::Workspace workspace;
  const ScoreParameters score = scoreParameters(ScoreFunction::MAGNUSSON, 0.55, 1.0);
  const NdtDerivatives near_result =
      NdtObjective(near_map.fine(), NeighborhoodSearchMethod::DIRECT7, score, {}).evaluate(source, T, 1, workspace);
  const NdtDerivatives far_result = NdtObjective(far_map.fine(), NeighborhoodSearchMethod::DIRECT7, score, {})
                                        .evaluate(source, shift * T, 1, workspace);
  // Doubles at 5e6 m resolve 1e-9 m, against standard deviations of 1e-2 m.
  EXPECT_NEAR(far_result.score, near_result.score, 1e-6 * near_result.score);
  EXPECT_LT((far_result.gradient() - near_result.gradient()).norm(), 1e-5 * near_result.gradient().norm());
}

TEST(NdtObjective, APoseThatIsNotFiniteOrTooFarMeetsNothing) {
  const NdtTarget map = exactTargetOf(streetCorner(1, 100));
  const SourcePoints source = sourceOf(streetCorner(2, 100));
  const NdtObjective objective(map.fine(), NeighborhoodSearchMethod::DIRECT7, {}, {});
  NdtObjective::Workspace workspace;
  for (const double x : {1e12, 1e300, std::numeric_limits<double>::infinity(), std::nan("")}) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation().x() = x;
    EXPECT_EQ(objective.evaluate(source, T, 1, workspace).pair_count, 0u);
  }
}

TEST(NdtObjective, ATargetWithoutDoublesIsRefusedWithWhatIsMissing) {
  WeightedMapBuilder builder(1.0);
  addCloud(builder, streetCorner(1, 100), Eigen::Isometry3d::Identity());
  const NdtTarget target(builder.build());
  expectThrows<std::invalid_argument>([&] { NdtObjective(target.fine(), NeighborhoodSearchMethod::DIRECT7, {}, {}); },
                                      {"Arithmetic::DOUBLE", "SINGLE_AND_DOUBLE"});
}

}  // namespace
}  // namespace saw_ndt
