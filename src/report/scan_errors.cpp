#include "report/scan_errors.h"

#include "saw_ndt/evaluation/metrics.h"

namespace saw_ndt {

ScanErrors scanErrors(const BenchmarkRun& run, const BenchmarkCell& cell) {
  ScanErrors errors;
  for (std::size_t i = 0; i < cell.run.results.size(); ++i) {
    const PoseError error = poseError(run.T_map_base[i], cell.run.results[i].T_map_base);
    errors.position_error_m.push_back(error.position_m);
    errors.yaw_error_deg.push_back(error.yaw_deg);
  }
  return errors;
}

std::vector<double> distancesDriven(const BenchmarkRun& run) {
  std::vector<double> distances_m;
  for (std::size_t i = 0; i < run.T_map_base.size(); ++i) {
    const double step_m = i == 0 ? 0.0 : (run.T_map_base[i].translation() - run.T_map_base[i - 1].translation()).norm();
    distances_m.push_back((i == 0 ? 0.0 : distances_m.back()) + step_m);
  }
  return distances_m;
}

double distanceSkipped(const BenchmarkRun& run) {
  const std::vector<double> distances_m = distancesDriven(run);
  const std::vector<LocalizationResult>& results = run.cells.front().run.results;
  double skipped_m = 0.0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (results[i].stamp_s - results.front().stamp_s < run.skip_s) skipped_m = distances_m[i];
  }
  return skipped_m;
}

}  // namespace saw_ndt
