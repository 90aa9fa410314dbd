#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report/benchmark.h"
#include "report/benchmark_text.h"

namespace saw_ndt {

/// One JSON object with a line break at its end: the record of the run, "cells" (drive, sequence, accepted_share and
/// the members of summary.json), "macro_averages" (drive, method and a member for each of benchmarkColumns()) and
/// "ate_over_classical" (drive, method, a member for each sequence, and macro_average; null where it is not finite).
std::string toJsonText(const std::vector<BenchmarkRun>& runs, const std::vector<BenchmarkTable>& tables,
                       const RunRecord& record);

/// Writes table.md, table.csv, table.json and, for each cell, the folder `<sequence>/<same|other>/<method>` with the
/// files of writeLocalization() into a folder that exists. @throws Error
void writeBenchmark(const std::filesystem::path& folder, const std::vector<BenchmarkRun>& runs,
                    const std::vector<BenchmarkTable>& tables, const BenchmarkText& text);

}  // namespace saw_ndt
