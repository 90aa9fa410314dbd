#include "evaluation/statistics.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace {

void requireValues(const std::vector<double>& values) {
  if (values.empty()) throw std::invalid_argument("statistics of no values");
}

}  // namespace

double mean(const std::vector<double>& values) {
  requireValues(values);
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double percentile(std::vector<double> values, double percent) {
  requireValues(values);
  checkOption(percent >= 0.0 && percent <= 100.0, "percent", percent, "from 0 to 100");
  std::sort(values.begin(), values.end());
  const double rank = percent / 100.0 * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(rank);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (rank - static_cast<double>(below)) * (values[above] - values[below]);
}

double median(std::vector<double> values) { return percentile(std::move(values), 50.0); }

DurationStatistics durationStatistics(const std::vector<double>& durations) {
  return {mean(durations), median(durations), percentile(durations, 95.0),
          *std::max_element(durations.begin(), durations.end())};
}

}  // namespace saw_ndt::internal
