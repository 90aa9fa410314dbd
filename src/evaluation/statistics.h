#pragma once

#include <vector>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

// All of these throw std::invalid_argument for no values.

SAW_NDT_EXPORT double mean(const std::vector<double>& values);

/// The value below which `percent` (0 to 100) of the values lie, interpolated linearly between the two nearest ranks:
/// rank percent / 100 * (n - 1) of the sorted values, as NumPy's default.
SAW_NDT_EXPORT double percentile(std::vector<double> values, double percent);

/// percentile(values, 50)
SAW_NDT_EXPORT double median(std::vector<double> values);

/// Summary of the run times of many scans, in the unit of the values it was made from (ms in all reports).
struct DurationStatistics {
  double mean = 0.0;
  double p50 = 0.0;
  double p95 = 0.0;
  double max = 0.0;
};

SAW_NDT_EXPORT DurationStatistics durationStatistics(const std::vector<double>& durations);

}  // namespace saw_ndt::internal
