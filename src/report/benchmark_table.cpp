#include "report/benchmark_table.h"

#include <algorithm>
#include <stdexcept>

namespace saw_ndt {
namespace {

using Figures = BenchmarkFigures;

constexpr char kClassical[] = "classical";

BenchmarkRow macroAverage(const BenchmarkTable& table, const std::string& method) {
  BenchmarkRow average{"macro average", method, {}};
  for (const BenchmarkColumn& column : benchmarkColumns()) {
    for (const std::string& sequence : table.sequences) {
      average.figures.*column.figure += table.row(sequence, method).figures.*column.figure;
    }
    average.figures.*column.figure /= static_cast<double>(table.sequences.size());
  }
  return average;
}

BenchmarkTable tableOf(const std::vector<BenchmarkRun>& runs, MapDrive drive) {
  BenchmarkTable table;
  table.drive = drive;
  for (const BenchmarkRun& run : runs) {
    if (run.drive != drive) continue;
    table.sequences.push_back(run.sequence);
    for (const BenchmarkCell& cell : run.cells) {
      table.rows.push_back({run.sequence, cell.method, figuresOf(cell.summary)});
      if (table.sequences.size() == 1) table.methods.push_back(cell.method);
    }
  }
  for (const std::string& method : table.methods) table.macro_averages.push_back(macroAverage(table, method));
  return table;
}

}  // namespace

const std::vector<BenchmarkColumn>& benchmarkColumns() {
  static const std::vector<BenchmarkColumn> columns{
      {"total_ms_mean", &Figures::total_ms_mean},
      {"total_ms_p95", &Figures::total_ms_p95},
      {"ate_rmse_m", &Figures::ate_rmse_m},
      {"position_p95_m", &Figures::position_p95_m},
      {"position_max_m", &Figures::position_max_m},
      {"yaw_mae_deg", &Figures::yaw_mae_deg},
      {"yaw_p95_deg", &Figures::yaw_p95_deg},
      {"accepted_share", &Figures::accepted_share},
      {"likelihood_mean", &Figures::likelihood_mean},
      {"nearest_voxel_likelihood_mean", &Figures::nearest_voxel_likelihood_mean},
      {"source_points_mean", &Figures::source_points_mean},
      {"segment_ms_mean", &Figures::segment_ms_mean},
      {"filter_ms_mean", &Figures::filter_ms_mean},
      {"align_ms_mean", &Figures::align_ms_mean},
      {"evaluations_mean", &Figures::evaluations_mean},
  };
  return columns;
}

BenchmarkFigures figuresOf(const LocalizationSummary& summary) {
  if (!summary.metrics) throw std::invalid_argument("figuresOf: " + summary.method + " has no metrics");
  Figures figures;
  figures.total_ms_mean = summary.total_ms.mean;
  figures.total_ms_p95 = summary.total_ms.p95;
  figures.ate_rmse_m = summary.metrics->ate_rmse_m;
  figures.position_p95_m = summary.metrics->position_p95_m;
  figures.position_max_m = summary.metrics->position_max_m;
  figures.yaw_mae_deg = summary.metrics->yaw_mae_deg;
  figures.yaw_p95_deg = summary.metrics->yaw_p95_deg;
  figures.accepted_share = static_cast<double>(summary.accepted) / static_cast<double>(summary.scans);
  figures.likelihood_mean = summary.likelihood_mean;
  figures.nearest_voxel_likelihood_mean = summary.nearest_voxel_likelihood_mean;
  figures.source_points_mean = summary.source_points_mean;
  figures.segment_ms_mean = summary.segment_ms.mean;
  figures.filter_ms_mean = summary.filter_ms.mean;
  figures.align_ms_mean = summary.align_ms.mean;
  figures.evaluations_mean = summary.evaluations_mean;
  return figures;
}

const BenchmarkRow& BenchmarkTable::row(const std::string& sequence, const std::string& method) const {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const BenchmarkRow& row) {
    return row.sequence == sequence && row.method == method;
  });
  if (found == rows.end()) throw std::out_of_range("BenchmarkTable: no row of " + sequence + " and " + method);
  return *found;
}

std::vector<double> BenchmarkTable::ateOverClassical(const std::string& method) const {
  const auto classical = std::find(methods.begin(), methods.end(), kClassical);
  if (classical == methods.end()) return {};
  std::vector<double> ratios;
  for (const std::string& sequence : sequences) {
    ratios.push_back(row(sequence, method).figures.ate_rmse_m / row(sequence, kClassical).figures.ate_rmse_m);
  }
  const auto averageOf = [&](const std::string& name) {
    const auto found = std::find(methods.begin(), methods.end(), name);
    return macro_averages.at(static_cast<std::size_t>(found - methods.begin())).figures.ate_rmse_m;
  };
  ratios.push_back(averageOf(method) / averageOf(kClassical));
  return ratios;
}

std::vector<BenchmarkTable> benchmarkTables(const std::vector<BenchmarkRun>& runs) {
  std::vector<BenchmarkTable> tables;
  for (const BenchmarkRun& run : runs) {
    const auto known = [&](const BenchmarkTable& table) { return table.drive == run.drive; };
    if (std::none_of(tables.begin(), tables.end(), known)) tables.push_back(tableOf(runs, run.drive));
  }
  return tables;
}

}  // namespace saw_ndt
