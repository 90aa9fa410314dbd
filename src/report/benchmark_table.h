#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/benchmark.h"

namespace saw_ndt {

/// The figures of a line of Table I, those of the paper first. Times in ms.
struct BenchmarkFigures {
  double total_ms_mean = 0.0;
  double total_ms_p95 = 0.0;
  double ate_rmse_m = 0.0;
  double position_p95_m = 0.0;
  double position_max_m = 0.0;
  double yaw_mae_deg = 0.0;
  double yaw_p95_deg = 0.0;
  double accepted_share = 0.0;  ///< of all scans, in [0, 1]
  double likelihood_mean = 0.0;
  double nearest_voxel_likelihood_mean = 0.0;
  double source_points_mean = 0.0;
  double segment_ms_mean = 0.0;
  double filter_ms_mean = 0.0;
  double align_ms_mean = 0.0;
  double evaluations_mean = 0.0;
};

/// A figure and the name it has in files.
struct BenchmarkColumn {
  const char* name;
  double BenchmarkFigures::*figure;
};

/// All figures in their order.
const std::vector<BenchmarkColumn>& benchmarkColumns();

/// The figures of a run. @throws std::invalid_argument where the summary has no metrics
BenchmarkFigures figuresOf(const LocalizationSummary& summary);

struct BenchmarkRow {
  std::string sequence;
  std::string method;
  BenchmarkFigures figures;
};

/// The results in the maps of one kind of drive.
struct BenchmarkTable {
  MapDrive drive = MapDrive::SAME;
  std::vector<std::string> sequences;        ///< in the order of the rows
  std::vector<std::string> methods;          ///< in the order of the rows
  std::vector<BenchmarkRow> rows;            ///< each method on each sequence, sequence by sequence
  std::vector<BenchmarkRow> macro_averages;  ///< a row a method: the plain mean over the sequences

  /// The row of a sequence and method. @throws std::out_of_range where there is none
  const BenchmarkRow& row(const std::string& sequence, const std::string& method) const;
  /// The absolute trajectory error of a method over that of `classical`, on each sequence and last for the macro
  /// averages; empty where `classical` is no method of the table, an entry is not finite where its error is 0.
  std::vector<double> ateOverClassical(const std::string& method) const;
};

/// One table for each kind of drive that the runs are of.
std::vector<BenchmarkTable> benchmarkTables(const std::vector<BenchmarkRun>& runs);

}  // namespace saw_ndt
