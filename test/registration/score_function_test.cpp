#include "registration/score_function.h"

#include <gtest/gtest.h>

#include <cmath>

namespace saw_ndt {

using namespace internal;

namespace {

// Magnusson's function is fitted to -log(c1 exp(-m/2) + c2) at m = 0, 1 and infinity, with c1 = 10 (1 - ratio) and
// c2 = ratio / resolution^3.
TEST(ScoreFunction, MagnussonFitsTheMixtureAtTheCentreAndAtOneSigma) {
  for (const double resolution : {0.025, 0.5, 1.0, 3.0}) {
    for (const double ratio : {0.1, 0.55, 0.9}) {
      const double c1 = 10.0 * (1.0 - ratio), c2 = ratio / std::pow(resolution, 3);
      const ScoreParameters parameters = scoreParameters(ScoreFunction::MAGNUSSON, ratio, resolution);
      // log1p and not log: at 0.025 m c1 / c2 is 1e-4 and the difference of the logarithms would lose digits.
      EXPECT_NEAR(parameters.amplitude, std::log1p(c1 / c2), 1e-12 * parameters.amplitude);
      EXPECT_NEAR(parameters.amplitude * std::exp(-parameters.d2 / 2.0), std::log1p(c1 / c2 * std::exp(-0.5)),
                  1e-12 * parameters.amplitude);
    }
  }
}

TEST(ScoreFunction, PaperIsAPlainExponential) {
  const ScoreParameters parameters = scoreParameters(ScoreFunction::PAPER, 0.55, 1.0);
  EXPECT_EQ(parameters.amplitude, 1.0);
  EXPECT_EQ(parameters.d2, 1.0);
}

}  // namespace
}  // namespace saw_ndt
