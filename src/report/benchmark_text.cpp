#include "report/benchmark_text.h"

#include <cmath>
#include <iomanip>
#include <set>
#include <sstream>

#include "report/paper_table.h"

namespace saw_ndt {
namespace {

using Figures = BenchmarkFigures;

constexpr int kTimeDigits = 1, kMetreDigits = 4, kDegreeDigits = 4;

std::string fixed(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

std::string slashed(std::initializer_list<double> values, int digits) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : " / ") + fixed(value, digits);
  return text;
}

/// The paper's four columns.
std::vector<std::string> paperCells(const Figures& f) {
  return {slashed({f.total_ms_mean, f.total_ms_p95}, kTimeDigits), fixed(f.ate_rmse_m, kMetreDigits),
          slashed({f.position_p95_m, f.position_max_m}, kMetreDigits),
          slashed({f.yaw_mae_deg, f.yaw_p95_deg}, kDegreeDigits)};
}

std::vector<std::string> resultCells(const BenchmarkRow& row) {
  const Figures& f = row.figures;
  std::vector<std::string> cells{row.sequence, row.method};
  for (const std::string& cell : paperCells(f)) cells.push_back(cell);
  cells.push_back(fixed(100.0 * f.accepted_share, 1));
  cells.push_back(fixed(f.likelihood_mean, 3));
  cells.push_back(fixed(f.nearest_voxel_likelihood_mean, 3));
  cells.push_back(fixed(f.source_points_mean, 0));
  cells.push_back(slashed({f.segment_ms_mean, f.filter_ms_mean, f.align_ms_mean}, kTimeDigits));
  return cells;
}

std::vector<std::string> comparedCells(const BenchmarkRow& ours, const BenchmarkRow& paper) {
  const std::vector<std::string> our_cells = paperCells(ours.figures), paper_cells = paperCells(paper.figures);
  std::vector<std::string> cells{ours.sequence, ours.method};
  for (std::size_t i = 0; i < our_cells.size(); ++i) {
    cells.push_back(our_cells[i]);
    cells.push_back(paper_cells[i]);
  }
  return cells;
}

std::string titled(const std::string& title, MapDrive drive) {
  return title + (drive == MapDrive::SAME ? ", map of the same drive" : ", map of another drive");
}

std::string markdownCell(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '|' ? std::string("\\|") : std::string(1, c);
  return result;
}

std::string markdownLine(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (const std::string& cell : cells) line += " " + markdownCell(cell) + " |";
  return line + "\n";
}

std::string csvCell(const std::string& text) {
  if (text.find_first_of(",\"\n#") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + "\"";
}

}  // namespace

TextTable resultTable(const BenchmarkTable& table) {
  TextTable text{
      titled("Results", table.drive),
      {"Seq.", "Method", "Time mean / P95 (ms)", "ATE/RMSE (m)", "Position P95 / max (m)", "Yaw MAE / P95 (deg)",
       "Accepted (%)", "Likelihood", "Nearest-voxel likelihood", "Source points", "Segment / filter / align (ms)"},
      {}};
  for (const BenchmarkRow& row : table.rows) text.rows.push_back(resultCells(row));
  if (table.sequences.size() < 2) return text;
  for (const BenchmarkRow& row : table.macro_averages) text.rows.push_back(resultCells(row));
  return text;
}

TextTable ratioTable(const BenchmarkTable& table) {
  TextTable text{titled("ATE over that of classical", table.drive), {"Method"}, {}};
  for (const std::string& sequence : table.sequences) text.header.push_back(sequence);
  const bool with_average = table.sequences.size() > 1;
  if (with_average) text.header.emplace_back("macro average");
  for (const std::string& method : table.methods) {
    std::vector<double> ratios = table.ateOverClassical(method);
    if (ratios.empty()) continue;
    if (!with_average) ratios.pop_back();
    text.rows.push_back({method});
    for (const double ratio : ratios) text.rows.back().push_back(std::isfinite(ratio) ? fixed(ratio, 3) : "");
  }
  return text;
}

TextTable paperComparison(const BenchmarkTable& table) {
  TextTable text{titled("Beside the paper's Table I", table.drive),
                 {"Seq.", "Method", "Time mean / P95 (ms)", "paper's", "ATE/RMSE (m)", "paper's",
                  "Position P95 / max (m)", "paper's", "Yaw MAE / P95 (deg)", "paper's"},
                 {}};
  std::set<std::string> paper_sequences;
  for (const BenchmarkRow& row : paperTable()) paper_sequences.insert(row.sequence);
  for (const BenchmarkRow& row : table.rows) {
    if (const BenchmarkRow* paper = paperRow(row.sequence, row.method)) text.rows.push_back(comparedCells(row, *paper));
  }
  if (paper_sequences != std::set<std::string>(table.sequences.begin(), table.sequences.end())) return text;
  for (const BenchmarkRow& row : table.macro_averages) {
    if (const BenchmarkRow* paper = paperMacroAverage(row.method)) text.rows.push_back(comparedCells(row, *paper));
  }
  return text;
}

BenchmarkText benchmarkText(const std::vector<BenchmarkTable>& tables, const RunRecord& record, bool with_paper) {
  BenchmarkText text{record, {}};
  const auto add = [&](const TextTable& table) {
    if (!table.rows.empty()) text.tables.push_back(table);
  };
  for (const BenchmarkTable& table : tables) {
    add(resultTable(table));
    add(ratioTable(table));
    if (with_paper) add(paperComparison(table));
  }
  return text;
}

std::string toMarkdown(const BenchmarkText& text) {
  std::ostringstream out;
  for (const TextTable& table : text.tables) {
    out << "## " << table.title << "\n\n" << markdownLine(table.header) << '|';
    for (std::size_t i = 0; i < table.header.size(); ++i) out << "---|";
    out << '\n';
    for (const std::vector<std::string>& row : table.rows) out << markdownLine(row);
    out << '\n';
  }
  const RunRecord& record = text.record;
  out << "Made on " << record.date << " on " << record.cpu_model << ", " << record.threads << " of " << record.cores
      << " cores, by\n\n    " << record.command << '\n';
  return out.str();
}

std::string toCsv(const std::vector<BenchmarkTable>& tables, const RunRecord& record) {
  std::ostringstream out;
  out << "# command: " << record.command << "\n# date: " << record.date << "\n# cpu_model: " << record.cpu_model
      << "\n# cores: " << record.cores << "\n# threads: " << record.threads << "\ndrive,sequence,method";
  for (const BenchmarkColumn& column : benchmarkColumns()) out << ',' << column.name;
  out << '\n' << std::setprecision(9);
  for (const BenchmarkTable& table : tables) {
    for (const auto* rows : {&table.rows, &table.macro_averages}) {
      for (const BenchmarkRow& row : *rows) {
        out << shortName(table.drive) << ',' << csvCell(row.sequence) << ',' << row.method;
        for (const BenchmarkColumn& column : benchmarkColumns()) out << ',' << row.figures.*column.figure;
        out << '\n';
      }
    }
  }
  return out.str();
}

}  // namespace saw_ndt
