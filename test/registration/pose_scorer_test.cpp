#include "saw_ndt/registration/pose_scorer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "map/map_fixtures.h"
#include "registration/likelihoods.h"
#include "registration/registration_fixtures.h"

namespace saw_ndt {

using namespace internal;

namespace {

class PoseScorerTest : public ::testing::Test {
 protected:
  PoseScorerTest() {
    std::mt19937 random(5);
    for (int i = 0; i < 40; ++i) poses.push_back(randomPose(random, 2.0, 0.3));
    poses.push_back(Eigen::Isometry3d::Identity());
    poses.push_back(Eigen::Isometry3d(Eigen::Translation3d(900.0, -400.0, 0.0)));
  }

  NdtTarget target = NdtTarget(mapOf(streetCorner(1)));
  SourcePoints source = sourceOf(streetCorner(2, 3000));
  std::vector<Eigen::Isometry3d> poses;
};

TEST_F(PoseScorerTest, AgreesWithTheLikelihoodsOfAnAlignment) {
  PoseScorer scorer(target, source);
  const std::vector<Likelihoods> scores = scorer.score(poses, 1);
  ASSERT_EQ(scores.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Likelihoods expected = evaluateLikelihoods(target.fine(), source, poses[i], 0.55, 1);
    // Points come in another order, so that single precision rounds otherwise.
    EXPECT_NEAR(scores[i].unweighted, expected.unweighted, 1e-5) << i;
    EXPECT_NEAR(scores[i].non_ground, expected.non_ground, 1e-5) << i;
    EXPECT_NEAR(scores[i].nearest_voxel, expected.nearest_voxel, 1e-5) << i;
  }
  // The first one above is the best: the corner seen from where it is.
  const auto best = std::max_element(scores.begin(), scores.end(), [](const Likelihoods& a, const Likelihoods& b) {
    return a.unweighted < b.unweighted;
  });
  EXPECT_EQ(best - scores.begin(), 40);
  EXPECT_EQ(scores.back().unweighted, 0.0);
}

TEST_F(PoseScorerTest, NeitherThreadsNorOtherPosesChangeABit) {
  PoseScorer scorer(target, source);
  const std::vector<Likelihoods> expected = scorer.score(poses, 1);
  std::vector<std::size_t> order(poses.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = (7 * i + 3) % order.size();
  for (const int threads : {1, 2, 0}) {
    std::vector<Eigen::Isometry3d> shuffled;
    for (const std::size_t i : order) shuffled.push_back(poses[i]);
    const std::vector<Likelihoods> scores = scorer.score(shuffled, threads);
    for (std::size_t k = 0; k < order.size(); ++k) {
      EXPECT_EQ(scores[k].unweighted, expected[order[k]].unweighted);
      EXPECT_EQ(scores[k].non_ground, expected[order[k]].non_ground);
      EXPECT_EQ(scores[k].nearest_voxel, expected[order[k]].nearest_voxel);
    }
  }
}

TEST_F(PoseScorerTest, RefusesAnOutlierRatioThatIsNone) {
  for (const double ratio : {0.0, 1.0, std::nan("")}) {
    EXPECT_THROW(PoseScorer(target, source, ratio), std::invalid_argument) << ratio;
  }
}

}  // namespace
}  // namespace saw_ndt
