#include "evaluation/statistics.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace saw_ndt {

using namespace internal;

namespace {

TEST(Statistics, PercentileInterpolatesLinearly) {
  const std::vector<double> values{4.0, 1.0, 3.0, 2.0};
  EXPECT_DOUBLE_EQ(percentile(values, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(percentile(values, 25.0), 1.75);
  EXPECT_DOUBLE_EQ(percentile(values, 95.0), 3.85);
  EXPECT_DOUBLE_EQ(percentile(values, 100.0), 4.0);
  EXPECT_DOUBLE_EQ(percentile({7.0}, 95.0), 7.0);
  EXPECT_DOUBLE_EQ(median(values), 2.5);
  EXPECT_DOUBLE_EQ(mean(values), 2.5);
}

TEST(Statistics, SummarizesDurations) {
  const DurationStatistics statistics = durationStatistics({10.0, 20.0, 60.0});
  EXPECT_DOUBLE_EQ(statistics.mean, 30.0);
  EXPECT_DOUBLE_EQ(statistics.p50, 20.0);
  EXPECT_DOUBLE_EQ(statistics.p95, 56.0);
  EXPECT_DOUBLE_EQ(statistics.max, 60.0);
}

TEST(Statistics, RefusesNoValues) {
  EXPECT_THROW(mean({}), std::invalid_argument);
  EXPECT_THROW(percentile({}, 50.0), std::invalid_argument);
  EXPECT_THROW(percentile({1.0}, 101.0), std::invalid_argument);
  EXPECT_THROW(durationStatistics({}), std::invalid_argument);
}

}  // namespace
}  // namespace saw_ndt
