#pragma once

#include <string>
#include <vector>

#include "report/benchmark.h"
#include "report/run_record.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {

/// What a hand-made method does on a hand-made drive.
struct HandMadeMethod {
  std::string name;
  double error_m = 0.0;    ///< to the left, of every scan
  double time_ms = 10.0;   ///< of every scan
  int rejected_scans = 0;  ///< the last ones
};

/// A drive of straight road, 1 m and 0.1 s a scan, with a wall along it, and what the methods said.
inline BenchmarkRun handMadeRun(const std::string& sequence, MapDrive drive, int scan_count,
                                const std::vector<HandMadeMethod>& methods) {
  BenchmarkRun run;
  run.sequence = sequence;
  run.drive = drive;
  run.map_scans = static_cast<std::size_t>(scan_count);
  run.min_likelihood = 0.8;
  std::vector<double> stamps_s;
  for (int scan = 0; scan < scan_count; ++scan) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation().x() = scan;
    run.T_map_base.push_back(T);
    stamps_s.push_back(0.1 * scan);
    for (const float y : {0.0F, 6.0F}) {
      VoxelPoint voxel;
      voxel.x = static_cast<float>(scan);
      voxel.y = y;
      voxel.z = y;
      voxel.label = y > 0.0F ? 2 : 1;
      run.voxels.push_back(voxel);
    }
  }
  for (const HandMadeMethod& method : methods) {
    BenchmarkCell cell{method.name, {}, {}};
    for (int scan = 0; scan < scan_count; ++scan) {
      const auto i = static_cast<std::size_t>(scan);
      LocalizationResult result;
      result.stamp_s = stamps_s[i];
      result.T_map_base = run.T_map_base[i];
      result.T_map_base.translation().y() += method.error_m;
      result.track.pose_known = true;
      result.acceptance = scan < scan_count - method.rejected_scans ? Acceptance::ACCEPTED : Acceptance::LOW_LIKELIHOOD;
      result.alignment.likelihoods.unweighted = result.accepted() ? 2.0 : 0.5;
      result.source_points = 1000;
      result.times.total_ms = method.time_ms;
      cell.run.scans.push_back(scan);
      cell.run.names.push_back(std::to_string(scan) + ".bin");
      cell.run.T_map_lidar_reference.push_back(run.T_map_base[i]);
      cell.run.results.push_back(result);
    }
    LocalizerOptions options;
    options.method.name = method.name;
    options.alignment.threads = 1;
    cell.summary = summarize(cell.run, options, run.skip_s);
    run.cells.push_back(cell);
  }
  return run;
}

inline const RunRecord kHandMadeRecord{"saw_ndt_benchmark 00 -output 'a b'", "2026-01-31 12:00:00 UTC",
                                       "Some CPU <fast> & cheap", 8, 4};

}  // namespace saw_ndt
