#include "io/stamp_check.h"

#include <gtest/gtest.h>

#include <cmath>

namespace saw_ndt::internal {
namespace {

/// Stamps a period (s) apart, in another unit, rounded to a step where one is given.
std::vector<double> stamps(double period_s, double units_per_s = 1.0, double first_s = 0.0, double step_s = 0.0) {
  std::vector<double> all;
  for (int i = 0; i < 40; ++i) {
    double stamp_s = first_s + period_s * i;
    if (step_s > 0.0) stamp_s = step_s * std::floor(stamp_s / step_s + 1e-6);
    all.push_back(stamp_s * units_per_s);
  }
  return all;
}

void expectSaid(const std::vector<double>& stamps_s, const std::vector<std::string>& parts) {
  const std::vector<std::string> said = oddStamps(stamps_s);
  ASSERT_EQ(said.size(), 1U);
  for (const std::string& part : parts) EXPECT_NE(said[0].find(part), std::string::npos) << said[0];
}

TEST(OddStamps, OrdinaryOnesAreNot) {
  EXPECT_TRUE(oddStamps({}).empty());
  EXPECT_TRUE(oddStamps({1.7e9}).empty());
  for (const double period_s : {0.02, 0.05, 0.1, 1.0, 10.0}) {
    for (const double first_s : {0.0, 1.7e9, -5.0}) {
      EXPECT_TRUE(oddStamps(stamps(period_s, 1.0, first_s)).empty()) << period_s << ' ' << first_s;
    }
  }
  EXPECT_TRUE(oddStamps(stamps(0.1, 1.0, 0.0, 0.1)).empty());
  // A recording with a gap.
  std::vector<double> gap = stamps(0.1);
  for (std::size_t i = 20; i < gap.size(); ++i) gap[i] += 1e6;
  EXPECT_TRUE(oddStamps(gap).empty());
}

TEST(OddStamps, OtherUnitsAreTold) {
  for (const double period_s : {0.05, 0.1, 1.0}) {
    for (const double first_s : {0.0, 1.7e9}) {
      expectSaid(stamps(period_s, 1e9, first_s), {"seconds are needed", "nanoseconds: divide them by 1e9"});
      expectSaid(stamps(period_s, 1e6, first_s), {"microseconds: divide them by 1e6"});
      expectSaid(stamps(period_s, 1e3, first_s), {"milliseconds: divide them by 1e3"});
    }
  }
}

TEST(OddStamps, RoundedOnesAreTold) {
  expectSaid(stamps(0.05, 1.0, 0.0, 0.1),
             {"20 of 40 stamps equal", "number 1 from 0 (0 s)", "steps of 0.1 s", "rounded"});
  expectSaid(stamps(0.04, 1.0, 0.0, 0.1), {"steps of 0.1 s", "rounded"});
  expectSaid(stamps(0.1, 1.0, 1.7e9, 1.0), {"36 of 40", "(1700000000 s)", "steps of 1 s", "rounded"});
}

TEST(OddStamps, EqualAndFallingOnesAreTold) {
  std::vector<double> equal = stamps(0.1);
  equal[12] = equal[11];
  expectSaid(equal, {"1 of 40 stamps equal the one before", "number 12 from 0 (1.1 s)", "own time"});
  expectSaid(std::vector<double>(5, 3.0), {"4 of 5 stamps equal", "(3 s)"});
  std::vector<double> falling = stamps(0.1);
  falling[30] = 0.25;
  expectSaid(falling, {"1 of 40 stamps lie before", "number 30 from 0 (0.25 s)", "order of time"});
  falling[12] = falling[11];
  EXPECT_EQ(oddStamps(falling).size(), 2U);
}

}  // namespace
}  // namespace saw_ndt::internal
