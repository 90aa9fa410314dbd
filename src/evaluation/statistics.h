#pragma once

#include <vector>

namespace saw_ndt {

// All of these throw std::invalid_argument for no values.

double mean(const std::vector<double>& values);

/// The value below which `percent` (0 to 100) of the values lie, interpolated linearly between the two nearest ranks:
/// rank percent / 100 * (n - 1) of the sorted values, as NumPy's default.
double percentile(std::vector<double> values, double percent);

/// percentile(values, 50)
double median(std::vector<double> values);

/// Summary of the run times of many scans, in the unit of the values it was made from (ms in all reports).
struct DurationStatistics {
  double mean = 0.0;
  double p50 = 0.0;
  double p95 = 0.0;
  double max = 0.0;
};

DurationStatistics durationStatistics(const std::vector<double>& durations);

}  // namespace saw_ndt
