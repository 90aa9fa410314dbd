#include "registration/line_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace saw_ndt {

using namespace internal;

namespace {

// Functions of the kind that More and Thuente test with: a valley at a known place.
TEST(LineSearch, StepsSatisfyTheConditionsOnQuadraticsOfEveryWidth) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> log_width(-3.0, 1.0), log_first(-3.0, 1.0);
  for (int trial = 0; trial < 200; ++trial) {
    const double valley = std::pow(10.0, log_width(random));
    const auto function = [valley](double a) { return ValueAndSlope{(a - valley) * (a - valley), 2.0 * (a - valley)}; };
    const ValueAndSlope at_zero = function(0.0);
    const double step = moreThuenteStep(function, at_zero, std::pow(10.0, log_first(random)), 0.0, 100.0);
    EXPECT_LE(function(step).value, at_zero.value + 1e-4 * step * at_zero.slope);
    EXPECT_LE(function(step).slope, -0.9 * at_zero.slope);
    EXPECT_GT(step, 0.0);
  }
}

TEST(LineSearch, NeverRaisesAWavyFunction) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(0.1, 3.0);
  for (int trial = 0; trial < 200; ++trial) {
    const double frequency = 5.0 * uniform(random), depth = 0.3 * uniform(random);
    const auto function = [=](double a) {
      return ValueAndSlope{-a + a * a + depth * (std::cos(frequency * a) - 1.0) / frequency,
                           -1.0 + 2.0 * a - depth * std::sin(frequency * a)};
    };
    const double step = moreThuenteStep(function, function(0.0), uniform(random), 0.0, 10.0);
    EXPECT_LT(function(step).value, function(0.0).value);
  }
}

TEST(LineSearch, TakesTheLongestStepWhereTheFunctionOnlyFallsFaster) {
  const auto function = [](double a) { return ValueAndSlope{-a - a * a, -1.0 - 2.0 * a}; };
  EXPECT_DOUBLE_EQ(moreThuenteStep(function, function(0.0), 5.0, 0.0, 0.1), 0.1);
}

TEST(LineSearch, KeepsWithinItsBounds) {
  const auto function = [](double a) { return ValueAndSlope{(a - 1e-3) * (a - 1e-3), 2.0 * (a - 1e-3)}; };
  EXPECT_DOUBLE_EQ(moreThuenteStep(function, function(0.0), 1.0, 0.05, 0.05), 0.05);
}

}  // namespace
}  // namespace saw_ndt
