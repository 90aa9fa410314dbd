#include "registration/vectorized_ndt_objective.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <tuple>

#include "common/instruction_set.h"
#include "registration/registration_fixtures.h"

namespace saw_ndt {

using namespace internal;

namespace {

class VectorizedNdtObjectiveTest : public testing::Test {
 protected:
  void TearDown() override { limitInstructionSet(InstructionSet::AVX512); }

  OrderedSource ordered(const SourcePoints& source, const ConfidenceOptions& confidence = {}) {
    OrderedSource result;
    result.order(source, 1.0, confidence);
    return result;
  }

  BatchWorkspace workspace_;
};

struct Case {
  NeighborhoodSearchMethod method;
  bool weighted;
  InstructionSet instruction_set;
};

class VectorizedNdtObjectiveModes : public VectorizedNdtObjectiveTest, public testing::WithParamInterface<Case> {};

// A float holds 6e-8 of its value. Positions within 20 m of the origin round by up to 1e-6 m, 1e-4 of the standard
// deviations of 1 cm, each to a side of its own: over some thousand points that averages to a few 1e-6.
constexpr double kTolerance = 2e-5;

TEST_P(VectorizedNdtObjectiveModes, AgreesWithDoublePrecision) {
  limitInstructionSet(GetParam().instruction_set);
  const NdtTarget map = exactTargetOf(streetCorner(1));
  const ScoreParameters score = scoreParameters(ScoreFunction::MAGNUSSON, 0.55, 1.0);
  const PairWeighting weighting{GetParam().weighted, 0.3, map.weighting().confidence};
  const NdtObjective expected_objective(map.fine(), GetParam().method, score, weighting);
  const VectorizedNdtObjective objective(map.fine(), GetParam().method, score, weighting);
  NdtObjective::Workspace workspace;
  std::mt19937 random(3);
  for (const int points : {1, 7, 300, 1500}) {
    const SourcePoints all = sourceOf(streetCorner(2, points));
    // Of few points, roundings do not average out.
    const double tolerance = points < 100 ? 5.0 * kTolerance : kTolerance;
    for (int trial = 0; trial < 4; ++trial) {
      const Eigen::Isometry3d T = randomPose(random, 0.4, 0.1);
      const SourcePoints source = awayFromEvents(all, T, map.fine());
      OrderedSource source_in_order = ordered(source);
      const NdtDerivatives expected = expected_objective.evaluate(source, T, 1, workspace);
      const NdtDerivatives got = objective.evaluate(source_in_order, T, 1, workspace_);
      EXPECT_EQ(got.pair_count, expected.pair_count);
      if (expected.score < 1e-3) continue;  // so far off that a rounded position is a great share of what is left
      EXPECT_NEAR(got.score, expected.score, tolerance * expected.score);
      EXPECT_LE((got.gradient() - expected.gradient()).norm(), tolerance * expected.gradient().norm());
      EXPECT_LE((got.moment - expected.moment).norm(), tolerance * expected.moment.norm());
      EXPECT_LE((got.curvature - expected.curvature).norm(), tolerance * expected.curvature.norm());
      EXPECT_LE((got.radial_curvature - expected.radial_curvature).norm(),
                tolerance * expected.radial_curvature.norm());
    }
  }
}

std::vector<Case> allCases() {
  std::vector<Case> cases;
  for (const InstructionSet set : kInstructionSets) {
    for (const auto method :
         {NeighborhoodSearchMethod::DIRECT1, NeighborhoodSearchMethod::DIRECT3, NeighborhoodSearchMethod::DIRECT7,
          NeighborhoodSearchMethod::DIRECT26, NeighborhoodSearchMethod::RADIUS}) {
      for (const bool weighted : {false, true}) cases.push_back({method, weighted, set});
    }
  }
  return cases;
}

std::string nameOf(const testing::TestParamInfo<Case>& info) {
  constexpr std::array<const char*, 5> kMethods = {"Radius", "Direct26", "Direct7", "Direct3", "Direct1"};
  return std::string(kMethods[static_cast<std::size_t>(info.param.method)]) +
         (info.param.weighted ? "Weighted" : "Unweighted") + "_" + toString(info.param.instruction_set);
}

INSTANTIATE_TEST_SUITE_P(EveryModeAndInstructionSet, VectorizedNdtObjectiveModes, testing::ValuesIn(allCases()),
                         nameOf);

TEST_F(VectorizedNdtObjectiveTest, SameBitsForAnyNumberOfThreads) {
  const NdtTarget map = exactTargetOf(streetCorner(1));
  const SourcePoints source = sourceOf(streetCorner(2));
  const VectorizedNdtObjective objective(map.fine(), NeighborhoodSearchMethod::DIRECT7, {}, {true, 0.1, {}});
  for (const InstructionSet set : kInstructionSets) {
    limitInstructionSet(set);
    OrderedSource for_one = ordered(source);
    std::mt19937 random(7);
    std::vector<NdtDerivatives> expected;
    std::vector<Eigen::Isometry3d> poses;
    for (int i = 0; i < 3; ++i) {
      poses.push_back(randomPose(random, 0.4, 0.05));
      expected.push_back(objective.evaluate(for_one, poses.back(), 1, workspace_));
    }
    for (const int threads : {2, 3, 4}) {
      OrderedSource for_many = ordered(source);
      for (std::size_t i = 0; i < poses.size(); ++i) {
        const NdtDerivatives got = objective.evaluate(for_many, poses[i], threads, workspace_);
        EXPECT_EQ(got.score, expected[i].score);
        EXPECT_EQ(got.gradient(), expected[i].gradient());
        EXPECT_EQ(got.hessian(), expected[i].hessian());
      }
    }
  }
}

TEST_F(VectorizedNdtObjectiveTest, FarFromTheOriginNothingIsLost) {
  Eigen::Isometry3d shift = Eigen::Isometry3d::Identity();
  shift.translation() = Eigen::Vector3d(500000.0, 5000000.0, -300.0);
  const NdtTarget near_map = exactTargetOf(streetCorner(1)), far_map = exactTargetOf(streetCorner(1), shift);
  OrderedSource source = ordered(sourceOf(streetCorner(2, 500)));
  std::mt19937 random(8);
  const Eigen::Isometry3d T = randomPose(random, 0.2, 0.05);
  const ScoreParameters score = scoreParameters(ScoreFunction::MAGNUSSON, 0.55, 1.0);
  const auto evaluate = [&](const NdtTarget& map, const Eigen::Isometry3d& pose) {
    return VectorizedNdtObjective(map.fine(), NeighborhoodSearchMethod::DIRECT7, score, {})
        .evaluate(source, pose, 1, workspace_);
  };
  const NdtDerivatives near_result = evaluate(near_map, T), far_result = evaluate(far_map, shift * T);
  EXPECT_NEAR(far_result.score, near_result.score, kTolerance * near_result.score);
  EXPECT_LT((far_result.gradient() - near_result.gradient()).norm(), kTolerance * near_result.gradient().norm());
}

TEST_F(VectorizedNdtObjectiveTest, APoseThatIsNotFiniteOrTooFarMeetsNothing) {
  const NdtTarget map = exactTargetOf(streetCorner(1, 100));
  OrderedSource source = ordered(sourceOf(streetCorner(2, 100)));
  const VectorizedNdtObjective objective(map.fine(), NeighborhoodSearchMethod::DIRECT7, {}, {});
  for (const double x : {1e12, 1e300, std::numeric_limits<double>::infinity(), std::nan("")}) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation().x() = x;
    EXPECT_EQ(objective.evaluate(source, T, 1, workspace_).pair_count, 0U);
  }
}

// Points out of reach pair with nothing and leave the sums of the others alone.
TEST_F(VectorizedNdtObjectiveTest, PointsFarOutAreHarmless) {
  const NdtTarget map = exactTargetOf(streetCorner(1));
  const SourcePoints near_points = sourceOf(streetCorner(2, 300));
  SourcePoints with_far_points = near_points;
  for (const float far : {1e5F, 3e9F, 1e20F, std::numeric_limits<float>::max()}) {
    with_far_points.add(far, -far, 0.1F * far, StructuralLabel::NON_GROUND);
    with_far_points.add(-far, 0.0F, far, StructuralLabel::GROUND);
  }
  const ScoreParameters score = scoreParameters(ScoreFunction::MAGNUSSON, 0.55, 1.0);
  const VectorizedNdtObjective objective(map.fine(), NeighborhoodSearchMethod::DIRECT26, score, {});
  for (const InstructionSet set : kInstructionSets) {
    limitInstructionSet(set);
    OrderedSource near_source = ordered(near_points), far_source = ordered(with_far_points);
    const Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    const NdtDerivatives expected = objective.evaluate(near_source, T, 1, workspace_);
    const NdtDerivatives got = objective.evaluate(far_source, T, 1, workspace_);
    EXPECT_EQ(got.pair_count, expected.pair_count);
    EXPECT_NEAR(got.score, expected.score, 1e-6 * expected.score);
    EXPECT_LT((got.gradient() - expected.gradient()).norm(), kTolerance * expected.gradient().norm());
    EXPECT_LT((got.curvature - expected.curvature).norm(), 1e-6 * expected.curvature.norm());
  }
}

using Point = std::tuple<float, float, float, float, float>;

std::vector<Point> sortedPoints(const OrderedSource& source) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < source.size(); ++i) {
    points.emplace_back(source.x()[i], source.y()[i], source.z()[i], source.nonGround()[i], source.confidence()[i]);
  }
  std::sort(points.begin(), points.end());
  return points;
}

TEST_F(VectorizedNdtObjectiveTest, OrderingKeepsEveryPointWithItsLabelAndConfidence) {
  const ConfidenceOptions confidence{0.2, 0.4, 0.9};
  const NdtTarget map = exactTargetOf(streetCorner(1));
  std::mt19937 random(9);
  for (const int points : {0, 1, 3, 400, 2000}) {
    const SourcePoints source = sourceOf(streetCorner(2, points));
    std::vector<Point> expected;
    for (std::size_t i = 0; i < source.size(); ++i) {
      expected.emplace_back(source.x[i], source.y[i], source.z[i], source.label[i] == 1 ? 0.0F : 1.0F,
                            static_cast<float>(confidence.of(static_cast<StructuralLabel>(source.label[i]))));
    }
    std::sort(expected.begin(), expected.end());
    OrderedSource source_in_order = ordered(source, confidence);
    EXPECT_EQ(sortedPoints(source_in_order), expected);
    const VectorizedNdtObjective objective(map.fine(), NeighborhoodSearchMethod::DIRECT7, {}, {});
    for (int trial = 0; trial < 3; ++trial) {
      objective.evaluate(source_in_order, randomPose(random, 2.0, 3.0), 2, workspace_);
      EXPECT_EQ(sortedPoints(source_in_order), expected);
    }
  }
}

TEST_F(VectorizedNdtObjectiveTest, OrderDoesNotDependOnTheNumberOfThreads) {
  const SourcePoints source = sourceOf(streetCorner(2));
  const OrderedSource by_one = ordered(source);
  for (const int threads : {2, 3, 5}) {
    OrderedSource by_many;
    by_many.order(source, 1.0, {}, threads);
    ASSERT_EQ(by_many.size(), by_one.size());
    EXPECT_EQ(by_many.nonGroundCount(), by_one.nonGroundCount());
    EXPECT_TRUE(std::equal(by_one.x(), by_one.x() + by_one.size(), by_many.x()));
    EXPECT_TRUE(std::equal(by_one.confidence(), by_one.confidence() + by_one.size(), by_many.confidence()));
  }
}

TEST_F(VectorizedNdtObjectiveTest, ThinningTakesEveryNth) {
  OrderedSource all = ordered(sourceOf(streetCorner(2, 100)));
  OrderedSource thinned;
  thinned.thin(all, 4);
  ASSERT_EQ(thinned.size(), (all.size() + 3) / 4);
  for (std::size_t i = 0; i < thinned.size(); ++i) {
    EXPECT_EQ(thinned.x()[i], all.x()[4 * i]);
    EXPECT_EQ(thinned.nonGround()[i], all.nonGround()[4 * i]);
  }
}

}  // namespace
}  // namespace saw_ndt
