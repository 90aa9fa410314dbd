#pragma once

#include <string>
#include <vector>

#include "report/benchmark_table.h"
#include "report/run_record.h"

namespace saw_ndt {

/// A table as it is to be read.
struct TextTable {
  std::string title;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;  ///< each as long as the header
};

/// The table for readers: the paper's columns, then the others; the macro averages last where there are
/// several sequences.
TextTable resultTable(const BenchmarkTable& table);
/// The absolute trajectory errors over those of classical NDT. Without rows where that is no method of the table.
TextTable ratioTable(const BenchmarkTable& table);
/// The paper's Table I beside ours. Without rows where the table has none of its sequences; macro averages only where
/// its sequences are exactly the paper's.
TextTable paperComparison(const BenchmarkTable& table);

/// What a benchmark tells its readers.
struct BenchmarkText {
  RunRecord record;
  std::vector<TextTable> tables;
};

/// All of the tables that have rows. @param with_paper  whether paperComparison() is among them
BenchmarkText benchmarkText(const std::vector<BenchmarkTable>& tables, const RunRecord& record, bool with_paper);

/// A heading and a table each, and the record of the run.
std::string toMarkdown(const BenchmarkText& text);

/// One line a sequence and method, the macro averages among them as sequence "macro average"; the record of the run in
/// '#' comments above the header drive,sequence,method and the names of benchmarkColumns().
std::string toCsv(const std::vector<BenchmarkTable>& tables, const RunRecord& record);

}  // namespace saw_ndt
