#include "report/paper_table.h"

namespace saw_ndt {
namespace {

BenchmarkRow row(const char* sequence, const char* method, const double (&figures)[7]) {
  BenchmarkRow result{sequence, method, {}};
  for (std::size_t i = 0; i < 7; ++i) result.figures.*benchmarkColumns()[i].figure = figures[i];
  return result;
}

const BenchmarkRow* find(const std::vector<BenchmarkRow>& rows, const std::string& sequence,
                         const std::string& method) {
  for (const BenchmarkRow& candidate : rows) {
    if (candidate.sequence == sequence && candidate.method == method) return &candidate;
  }
  return nullptr;
}

const std::vector<BenchmarkRow>& macroAverages() {
  static const std::vector<BenchmarkRow> rows{
      row("macro average", "classical", {47.693, 68.055, 0.1621, 0.3809, 0.6409, 0.2232, 0.5558}),
      row("macro average", "unweighted-s50", {41.543, 75.680, 0.1553, 0.3864, 0.5488, 0.2137, 0.4954}),
      row("macro average", "weighted-s100", {41.994, 67.149, 0.5172, 0.4203, 3.0992, 0.2071, 0.4567}),
      row("macro average", "weighted-s50", {38.088, 56.841, 0.1498, 0.3734, 0.5654, 0.1912, 0.4331}),
  };
  return rows;
}

}  // namespace

const std::vector<BenchmarkRow>& paperTable() {
  static const std::vector<BenchmarkRow> rows{
      row("00", "classical", {43.508, 61.868, 0.3026, 0.8042, 1.0890, 0.2479, 0.6661}),
      row("00", "unweighted-s50", {46.931, 104.699, 0.3278, 0.9131, 1.0858, 0.2529, 0.6203}),
      row("00", "weighted-s100", {44.377, 86.306, 1.4175, 1.0109, 8.7111, 0.2837, 0.6294}),
      row("00", "weighted-s50", {41.381, 69.075, 0.3104, 0.8719, 1.0944, 0.2388, 0.5729}),
      row("01", "classical", {53.542, 79.229, 0.0998, 0.2115, 0.5199, 0.2685, 0.5964}),
      row("01", "unweighted-s50", {34.395, 46.027, 0.0716, 0.1464, 0.2759, 0.2295, 0.4557}),
      row("01", "weighted-s100", {36.621, 49.749, 0.0706, 0.1459, 0.3091, 0.1989, 0.3907}),
      row("01", "weighted-s50", {32.580, 44.568, 0.0708, 0.1431, 0.3142, 0.1974, 0.3924}),
      row("03", "classical", {46.029, 63.067, 0.0839, 0.1270, 0.3138, 0.1533, 0.4049}),
      row("03", "unweighted-s50", {43.304, 76.314, 0.0666, 0.0998, 0.2847, 0.1586, 0.4103}),
      row("03", "weighted-s100", {44.985, 65.393, 0.0636, 0.1042, 0.2774, 0.1387, 0.3499}),
      row("03", "weighted-s50", {40.302, 56.880, 0.0682, 0.1051, 0.2875, 0.1374, 0.3341}),
  };
  return rows;
}

const BenchmarkRow* paperRow(const std::string& sequence, const std::string& method) {
  return find(paperTable(), sequence, method);
}

const BenchmarkRow* paperMacroAverage(const std::string& method) {
  return find(macroAverages(), "macro average", method);
}

}  // namespace saw_ndt
