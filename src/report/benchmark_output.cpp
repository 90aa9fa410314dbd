#include "report/benchmark_output.h"

#include <nlohmann/json.hpp>
#include <system_error>

#include "common/atomic_output.h"
#include "report/json.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {

using namespace internal;

namespace {

using Json = nlohmann::ordered_json;

Json cellOf(const BenchmarkRun& run, const BenchmarkCell& cell) {
  Json json{{"drive", shortName(run.drive)},
            {"sequence", run.sequence},
            {"map_scans", run.map_scans},
            {"accepted_share", figuresOf(cell.summary).accepted_share}};
  json.update(toJson(cell.summary));
  return json;
}

Json averageOf(const BenchmarkTable& table, const BenchmarkRow& average) {
  Json json{{"drive", shortName(table.drive)}, {"method", average.method}};
  for (const BenchmarkColumn& column : benchmarkColumns()) json[column.name] = average.figures.*column.figure;
  return json;
}

Json ratiosOf(const BenchmarkTable& table, const std::string& method) {
  Json json{{"drive", shortName(table.drive)}, {"method", method}};
  const std::vector<double> ratios = table.ateOverClassical(method);
  for (std::size_t i = 0; i < table.sequences.size(); ++i) json["sequences"][table.sequences[i]] = ratios[i];
  json["macro_average"] = ratios.back();
  return json;
}

void writeText(const std::filesystem::path& path, const std::string& text) {
  AtomicOutput output(path);
  output.stream() << text;
  output.commit();
}

}  // namespace

std::string toJsonText(const std::vector<BenchmarkRun>& runs, const std::vector<BenchmarkTable>& tables,
                       const RunRecord& record) {
  Json json{{"command", record.command},       {"date", record.date},
            {"cpu_model", record.cpu_model},   {"cores", record.cores},
            {"threads", record.threads},       {"cells", Json::array()},
            {"macro_averages", Json::array()}, {"ate_over_classical", Json::array()}};
  for (const BenchmarkRun& run : runs) {
    for (const BenchmarkCell& cell : run.cells) json["cells"].push_back(cellOf(run, cell));
  }
  for (const BenchmarkTable& table : tables) {
    for (const BenchmarkRow& average : table.macro_averages)
      json["macro_averages"].push_back(averageOf(table, average));
    for (const std::string& method : table.methods) {
      if (!table.ateOverClassical(method).empty()) json["ate_over_classical"].push_back(ratiosOf(table, method));
    }
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void writeBenchmark(const std::filesystem::path& folder, const std::vector<BenchmarkRun>& runs,
                    const std::vector<BenchmarkTable>& tables, const BenchmarkText& text) {
  for (const BenchmarkRun& run : runs) {
    for (const BenchmarkCell& cell : run.cells) {
      const std::filesystem::path cell_folder = folder / run.sequence / shortName(run.drive) / cell.method;
      std::error_code error;
      std::filesystem::create_directories(cell_folder, error);
      if (error) throw Error(cell_folder.string(), "", error.message());
      writeLocalization(cell_folder, cell.run, cell.summary, run.T_base_lidar, run.T_camera_lidar);
    }
  }
  writeText(folder / "table.md", toMarkdown(text));
  writeText(folder / "table.csv", toCsv(tables, text.record));
  writeText(folder / "table.json", toJsonText(runs, tables, text.record));
}

}  // namespace saw_ndt
