#pragma once

#include <vector>

#include "report/benchmark.h"

namespace saw_ndt {

/// What a method did scan by scan, one value a scan.
struct ScanErrors {
  std::vector<double> position_error_m;
  std::vector<double> yaw_error_deg;  ///< without its sign
};

/// The errors of a cell against the reference poses of its run, as TrajectoryMetrics defines them.
ScanErrors scanErrors(const BenchmarkRun& run, const BenchmarkCell& cell);

/// Distance driven along the reference poses up to each scan (m), 0 for the first.
std::vector<double> distancesDriven(const BenchmarkRun& run);

/// Distance driven within the seconds that the metrics leave out (m).
double distanceSkipped(const BenchmarkRun& run);

}  // namespace saw_ndt
