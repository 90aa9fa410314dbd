#pragma once

#include <string>
#include <vector>

#include "report/benchmark_table.h"

namespace saw_ndt {

/// Table I of the paper: its methods on KITTI's 00, 01 and 03. Only the seven figures of the paper are set.
const std::vector<BenchmarkRow>& paperTable();

/// The paper's figures of a sequence and method; null where the paper has none.
const BenchmarkRow* paperRow(const std::string& sequence, const std::string& method);

/// The paper's macro averages of a method; null where the paper has none.
const BenchmarkRow* paperMacroAverage(const std::string& method);

}  // namespace saw_ndt
