#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report/benchmark.h"
#include "report/benchmark_text.h"

namespace saw_ndt {

/// Writes report.html, one file that needs no other: what was measured, how to read it, the tables, and for each run
/// the pictures of benchmarkPictures(), which are also written into plots/ as `<sequence>_<same|other>_<name>.png` and
/// .svg. Pictures are drawn by gnuplot; where that is missing or fails, the report says so in their place.
/// @param folder  exists
/// @return a clause on what is missing of the pictures; empty where nothing is
/// @throws Error where something cannot be written
std::string writeBenchmarkReport(const std::filesystem::path& folder, const std::vector<BenchmarkRun>& runs,
                                 const BenchmarkText& text);

}  // namespace saw_ndt
