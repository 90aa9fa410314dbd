#include "report/benchmark_table.h"

#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "benchmark_fixtures.h"
#include "report/benchmark_output.h"
#include "report/paper_table.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

/// Two drives in their own map, one of them in another one's, too.
class BenchmarkTables : public ::testing::Test {
 protected:
  const std::vector<BenchmarkRun> runs{
      handMadeRun("00", MapDrive::SAME, 4, {{"classical", 0.1, 20.0}, {"weighted", 0.05, 30.0, 1}}),
      handMadeRun("05", MapDrive::SAME, 4, {{"classical", 0.3, 40.0}, {"weighted", 0.25, 10.0}}),
      handMadeRun("05", MapDrive::OTHER, 4, {{"classical", 0.5, 40.0}, {"weighted", 0.6, 10.0}})};
  const std::vector<BenchmarkTable> tables = benchmarkTables(runs);
};

TEST_F(BenchmarkTables, OneForEachKindOfDrive) {
  ASSERT_EQ(tables.size(), 2U);
  EXPECT_EQ(tables[0].drive, MapDrive::SAME);
  EXPECT_EQ(tables[0].sequences, (std::vector<std::string>{"00", "05"}));
  EXPECT_EQ(tables[0].methods, (std::vector<std::string>{"classical", "weighted"}));
  EXPECT_EQ(tables[0].rows.size(), 4U);
  EXPECT_EQ(tables[1].drive, MapDrive::OTHER);
  EXPECT_EQ(tables[1].sequences, std::vector<std::string>{"05"});
  EXPECT_THROW(tables[1].row("00", "classical"), std::out_of_range);
}

TEST_F(BenchmarkTables, MacroAveragesArePlainMeans) {
  const BenchmarkFigures& classical = tables[0].macro_averages[0].figures;
  const BenchmarkFigures& weighted = tables[0].macro_averages[1].figures;
  EXPECT_NEAR(classical.ate_rmse_m, 0.2, 1e-12);
  EXPECT_NEAR(classical.total_ms_mean, 30.0, 1e-12);
  EXPECT_NEAR(weighted.ate_rmse_m, 0.15, 1e-12);
  EXPECT_NEAR(weighted.position_max_m, 0.15, 1e-12);
  EXPECT_NEAR(weighted.total_ms_p95, 20.0, 1e-12);
  EXPECT_NEAR(weighted.accepted_share, 0.875, 1e-12);
  EXPECT_NEAR(weighted.source_points_mean, 1000.0, 1e-12);
}

TEST_F(BenchmarkTables, RatiosAreOverClassical) {
  const std::vector<double> ratios = tables[0].ateOverClassical("weighted");
  ASSERT_EQ(ratios.size(), 3U);
  EXPECT_NEAR(ratios[0], 0.5, 1e-12);
  EXPECT_NEAR(ratios[1], 0.25 / 0.3, 1e-12);
  EXPECT_NEAR(ratios[2], 0.75, 1e-12);
  const auto alone = benchmarkTables({handMadeRun("00", MapDrive::SAME, 4, {{"weighted", 0.1}})});
  EXPECT_TRUE(alone[0].ateOverClassical("weighted").empty());
  EXPECT_EQ(benchmarkText(alone, kHandMadeRecord, true).tables.size(), 1U);  // neither ratios nor what the paper says
}

TEST_F(BenchmarkTables, MarkdownHasThePapersColumnsAndTheRecord) {
  const std::string markdown = toMarkdown(benchmarkText(tables, kHandMadeRecord, false));
  for (const std::string part :
       {"## Results, map of the same drive\n", "## Results, map of another drive\n",
        "| Seq. | Method | Time mean / P95 (ms) | ATE/RMSE (m) | Position P95 / max (m) | Yaw MAE / P95 (deg) |",
        "| 00 | weighted | 30.0 / 30.0 | 0.0500 | 0.0500 / 0.0500 | 0.0000 / 0.0000 | 75.0 |",
        "| macro average | weighted | 20.0 / 20.0 | 0.1500 | 0.1500 / 0.1500 | 0.0000 / 0.0000 | 87.5 |",
        "| weighted | 0.500 | 0.833 | 0.750 |", "2026-01-31 12:00:00 UTC", "Some CPU <fast> & cheap, 4 of 8 cores",
        "    saw_ndt_benchmark 00 -output 'a b'\n"}) {
    EXPECT_NE(markdown.find(part), std::string::npos) << "'" << part << "' is not in\n" << markdown;
  }
  // Every line of a table has as many cells as its header.
  std::size_t bars = 0;
  for (const std::string& line : split(markdown, '\n')) {
    if (line.empty() || line.front() != '|') {
      bars = 0;
      continue;
    }
    const auto count = static_cast<std::size_t>(std::count(line.begin(), line.end(), '|'));
    EXPECT_TRUE(bars == 0 || count == bars) << line;
    bars = count;
  }
  // One drive alone has no macro average.
  EXPECT_EQ(markdown.find("macro average", markdown.find("another drive")), std::string::npos);
}

TEST_F(BenchmarkTables, CsvAndJsonAgree) {
  const auto json = nlohmann::json::parse(toJsonText(runs, tables, kHandMadeRecord));
  EXPECT_EQ(json.at("command"), kHandMadeRecord.command);
  EXPECT_EQ(json.at("date"), kHandMadeRecord.date);
  EXPECT_EQ(json.at("cpu_model"), kHandMadeRecord.cpu_model);
  EXPECT_EQ(json.at("cores"), 8);
  EXPECT_EQ(json.at("threads"), 4);
  ASSERT_EQ(json.at("cells").size(), 6U);
  ASSERT_EQ(json.at("macro_averages").size(), 4U);
  EXPECT_NEAR(json.at("ate_over_classical")[1].at("macro_average").get<double>(), 0.75, 1e-12);
  EXPECT_NEAR(json.at("ate_over_classical")[1].at("sequences").at("00").get<double>(), 0.5, 1e-12);

  std::vector<std::string> lines;
  for (const std::string& line : split(toCsv(tables, kHandMadeRecord), '\n')) {
    if (line.front() != '#') lines.push_back(line);
  }
  ASSERT_EQ(lines.size(), 11U);
  const std::vector<std::string> header = split(lines[0], ',');
  std::size_t cell = 0, average = 0;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string> values = split(lines[i], ',');
    ASSERT_EQ(values.size(), header.size());
    std::map<std::string, std::string> row;
    for (std::size_t c = 0; c < header.size(); ++c) row[header[c]] = values[c];
    const bool is_average = row["sequence"] == "macro average";
    const nlohmann::json& member = is_average ? json.at("macro_averages")[average++] : json.at("cells")[cell++];
    EXPECT_EQ(member.at("method"), row["method"]);
    EXPECT_EQ(member.at("drive"), row["drive"]);
    for (const std::string name : {"ate_rmse_m", "position_p95_m", "yaw_mae_deg", "accepted_share"}) {
      EXPECT_NEAR(member.at(name).get<double>(), std::stod(row[name]), 1e-8) << lines[i];
    }
    const double time_ms = is_average ? member.at("total_ms_p95") : member.at("total_ms").at("p95");
    EXPECT_NEAR(time_ms, std::stod(row["total_ms_p95"]), 1e-6);
    if (!is_average) {
      EXPECT_EQ(member.at("sequence"), row["sequence"]);
    }
  }
}

TEST_F(BenchmarkTables, ACellOfJsonHasTheMembersOfItsSummary) {
  const auto json = nlohmann::json::parse(toJsonText(runs, tables, kHandMadeRecord));
  const auto summary = nlohmann::json::parse(toJsonText(runs[0].cells[1].summary));
  for (const auto& [name, value] : summary.items()) EXPECT_EQ(json.at("cells")[1].at(name), value) << name;
  EXPECT_EQ(json.at("cells")[1].at("accepted_share"), 0.75);
}

TEST_F(BenchmarkTables, WritesAFolderForEachCell) {
  const TemporaryFolder folder;
  writeBenchmark(folder.path(), runs, tables, benchmarkText(tables, kHandMadeRecord, false));
  for (const std::string name : {"table.md", "table.csv", "table.json", "00/same/weighted/frames.csv",
                                 "05/same/classical/summary.json", "05/other/weighted/trajectory_tum.txt"}) {
    EXPECT_TRUE(std::filesystem::is_regular_file(folder.path() / name)) << name;
  }
  EXPECT_EQ(folder.entryCount(), 5U);
}

TEST(PaperTable, ItsMacroAveragesAreThoseOfItsRows) {
  ASSERT_EQ(paperTable().size(), 12U);
  for (const std::string method : {"classical", "unweighted-s50", "weighted-s100", "weighted-s50"}) {
    for (std::size_t c = 0; c < 7; ++c) {
      double sum = 0.0;
      for (const std::string sequence : {"00", "01", "03"}) {
        sum += paperRow(sequence, method)->figures.*benchmarkColumns()[c].figure;
      }
      const double printed = paperMacroAverage(method)->figures.*benchmarkColumns()[c].figure;
      EXPECT_NEAR(sum / 3.0, printed, c < 2 ? 5.1e-4 : 5.1e-5) << method << ' ' << benchmarkColumns()[c].name;
    }
  }
  EXPECT_EQ(paperRow("00", "weighted"), nullptr);
  EXPECT_EQ(paperMacroAverage("pcl-ndt"), nullptr);
}

TEST(PaperTable, StandsBesideOurs) {
  const auto rowsBeside = [](const std::vector<std::string>& sequences) {
    std::vector<BenchmarkRun> runs;
    for (const std::string& name : sequences) {
      runs.push_back(handMadeRun(name, MapDrive::SAME, 3, {{"weighted-s50", 0.1, 20.0}, {"weighted", 0.1}}));
    }
    return paperComparison(benchmarkTables(runs)[0]).rows;
  };
  const auto rows = rowsBeside({"03", "00", "01"});
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[1],
            (std::vector<std::string>{"00", "weighted-s50", "20.0 / 20.0", "41.4 / 69.1", "0.1000", "0.3104",
                                      "0.1000 / 0.1000", "0.8719 / 1.0944", "0.0000 / 0.0000", "0.2388 / 0.5729"}));
  EXPECT_EQ(rows[3][0], "macro average");
  EXPECT_EQ(rows[3][5], "0.1498");
  EXPECT_EQ(rowsBeside({"00", "07"}).size(), 1U);  // the macro averages would not be of the same drives
  EXPECT_TRUE(rowsBeside({"07"}).empty());
}

TEST(RunRecord, QuotesTheCommandForTheShell) {
  const RunRecord record = recordRun({"app", "a b", "it's", "-x=1", ""}, 3);
  EXPECT_EQ(record.command, "app 'a b' 'it'\\''s' -x=1 ''");
  EXPECT_EQ(record.threads, 3);
  EXPECT_GE(record.cores, 1);
  EXPECT_FALSE(record.cpu_model.empty());
  EXPECT_EQ(record.date.size(), std::string("2026-01-31 12:00:00 UTC").size());
}

}  // namespace
}  // namespace saw_ndt
