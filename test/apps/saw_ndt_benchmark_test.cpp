#include <nlohmann/json.hpp>

#include "drive_files.h"

namespace saw_ndt {
namespace {

class BenchmarkApp : public DriveFiles {
 protected:
  BenchmarkApp() { writeKittiDrive(other_folder, driveDownTheStreet(SensorModel::named("VLP-16"), 7)); }

  AppResult benchmark(const std::string& options) const {
    return runAppProgram(SAW_NDT_APP, quoted(drive_folder) + "-output " + quoted(out) + kSensor + options);
  }
  void expectBenchmarkFails(const std::string& options, int exit_code, std::initializer_list<std::string> parts) const {
    expectFails(SAW_NDT_APP, quoted(drive_folder) + "-output " + quoted(out) + kSensor + options, exit_code, parts);
  }
  nlohmann::json table() const { return nlohmann::json::parse(contentOf(out / "table.json")); }

  const std::filesystem::path other_folder = folder.path() / "other";
  const std::filesystem::path out = folder.path() / "results" / "run 1";
};

TEST_F(BenchmarkApp, WritesTablesReportAndEveryTrajectory) {
  const AppResult result = benchmark("-skip 0");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.output, contentOf(out / "table.md"));
  EXPECT_NE(result.errors.find("saw_ndt_benchmark: 1 of 2: drive, same drive: building the map from 6 scans\n"),
            std::string::npos)
      << result.errors;
  EXPECT_NE(contentOf(out / "report.html").find("weighted-s50"), std::string::npos);
  const nlohmann::json json = table();
  EXPECT_NE(json.at("command").get<std::string>().find("-skip 0"), std::string::npos);
  EXPECT_EQ(json.at("threads"), 1);
  std::vector<std::string> methods;
  for (const nlohmann::json& cell : json.at("cells")) {
    methods.push_back(cell.at("method"));
    EXPECT_EQ(cell.at("accepted"), 6);
    EXPECT_LT(cell.at("position_max_m"), 0.03);
    const auto cell_folder = out / "drive" / "same" / methods.back();
    EXPECT_EQ(filesIn(cell_folder).size(), 4U);
    const auto summary = nlohmann::json::parse(contentOf(cell_folder / "summary.json"));
    EXPECT_EQ(summary.at("ate_rmse_m"), cell.at("ate_rmse_m"));
  }
  EXPECT_EQ(methods,
            (std::vector<std::string>{"classical", "unweighted-s50", "weighted-s100", "weighted-s50", "weighted"}));
  for (const auto& entry : std::filesystem::directory_iterator(out)) {
    EXPECT_NE(entry.path().filename().string().front(), '.') << entry.path();
  }
}

TEST_F(BenchmarkApp, ComparesMapsOfBothDrives) {
  const std::string options = "-skip 0.2 -methods classical,weighted -map-from " + quoted(other_folder);
  ASSERT_EQ(benchmark(options).exit_code, 0);
  ASSERT_EQ(table().at("cells").size(), 4U);
  EXPECT_EQ(table().at("cells")[0].at("drive"), "same");
  EXPECT_EQ(table().at("cells")[0].at("map_scans"), 6);
  EXPECT_EQ(table().at("cells")[3].at("drive"), "other");
  EXPECT_EQ(table().at("cells")[3].at("map_scans"), 7);
  EXPECT_EQ(table().at("cells")[3].at("evaluated_scans"), 4);

  const AppResult result = benchmark(options + "-drives other -map-scans ::2 -scans 1::2");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  ASSERT_EQ(table().at("cells").size(), 2U);
  EXPECT_EQ(table().at("cells")[0].at("map_scans"), 4);
  EXPECT_EQ(table().at("cells")[0].at("scans"), 3);
  EXPECT_EQ(result.output.find("same drive"), std::string::npos);
}

TEST_F(BenchmarkApp, LocalizesAsTheLocalizeApp) {
  ASSERT_EQ(benchmark("-skip 0 -methods weighted-s50,classical").exit_code, 0);
  const std::filesystem::path map_file = folder.path() / "a.map", single = folder.path() / "single";
  ASSERT_EQ(runAppProgram(SAW_NDT_BUILD_MAP_APP, quoted(drive_folder) + quoted(map_file) + kSensor).exit_code, 0);
  for (const std::string method : {"weighted-s50", "classical"}) {
    const AppResult result = runAppProgram(
        SAW_NDT_LOCALIZE_APP, quoted(drive_folder) + quoted(map_file) + quoted(single) + kSensor + "-method " + method);
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(contentOf(single / "trajectory_tum.txt"),
              contentOf(out / "drive" / "same" / method / "trajectory_tum.txt"));
  }
}

TEST_F(BenchmarkApp, ThePapersTableIsAdded) {
  const std::filesystem::path renamed = folder.path() / "03";
  std::filesystem::rename(drive_folder, renamed);
  const AppResult result = runAppProgram(
      SAW_NDT_APP, quoted(renamed) + "-output " + quoted(out) + kSensor + "-skip 0 -methods weighted-s50 -paper");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("40.3 / 56.9"), std::string::npos) << result.output;
}

TEST_F(BenchmarkApp, WithoutGnuplotThereIsANote) {
  const AppResult result =
      runAppProgram("/usr/bin/env", "PATH=/nowhere " + quoted(SAW_NDT_APP) + quoted(drive_folder) + "-output " +
                                        quoted(out) + kSensor + "-skip 0 -methods classical");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.errors.find("gnuplot is not installed"), std::string::npos) << result.errors;
  EXPECT_TRUE(std::filesystem::exists(out / "report.html"));
}

TEST_F(BenchmarkApp, WrongUsageIsNamed) {
  const std::string other = quoted(other_folder);
  expectFails(SAW_NDT_APP, quoted(drive_folder), 2, {"-output"});
  expectFails(SAW_NDT_APP, "-output " + quoted(out), 2, {"missing SEQUENCE"});
  expectBenchmarkFails("", 2, {"skip_s = 3", "drive", "lower -skip"});
  expectBenchmarkFails("-skip -1", 2, {"skip_s = -1"});
  expectBenchmarkFails("-skip 0 -methods weighted,best", 2, {"method = best", "pcl-ndt"});
  expectBenchmarkFails("-skip 0 -methods weighted,,classical", 2, {"-methods", "empty"});
  expectBenchmarkFails("-skip 0 -drives all", 2, {"-drives", "all", "both"});
  expectBenchmarkFails("-skip 0 -drives other", 2, {"drive", "no other drive"});
  expectBenchmarkFails("-skip 0 -map-from a,b", 2, {"-map-from", "2 drives", "1 are"});
  expectBenchmarkFails("-skip 0 -scans 9", 2, {"scan selection '9'"});
  expectBenchmarkFails("-skip 0 -resolution 0", 2, {"resolution"});
  expectFails(SAW_NDT_APP, quoted(drive_folder) + quoted(drive_folder) + "-skip 0 -output " + quoted(out), 2,
              {"twice"});
}

TEST_F(BenchmarkApp, BadDrivesAreNamedAndNothingStaysBehind) {
  // In the middle of the work, when the stages have been announced.
  const std::string scan = contentOf(drive_folder / "velodyne" / "000004.bin");
  replace("velodyne/000004.bin", scan.substr(0, 1003));
  const auto before = filesIn(folder.path());
  const AppResult result = benchmark("-skip 0");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.errors.find("000004.bin: offset 992"), std::string::npos) << result.errors;
  EXPECT_EQ(result.output, "");
  EXPECT_TRUE(filesIn(folder.path()) == before);
  replace("velodyne/000004.bin", scan);

  std::filesystem::remove(drive_folder / "poses.txt");
  expectBenchmarkFails("-skip 0", 1, {"poses.txt", "no poses"});
  expectFails(SAW_NDT_APP, quoted(folder.path() / "none") + "-output " + quoted(out), 1, {"none: No such file"});
}

TEST_F(BenchmarkApp, ResultsOfAnEarlierRunStayWhereNewOnesCannotTakeTheirPlace) {
  std::filesystem::create_directories(out / "table.csv");
  folder.write("results/run 1/table.md", "earlier");
  const auto before = filesIn(folder.path());
  const AppResult result = benchmark("-skip 0 -methods classical");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.errors.find("table.csv: is a folder"), std::string::npos) << result.errors;
  EXPECT_TRUE(filesIn(folder.path()) == before);
}

}  // namespace
}  // namespace saw_ndt
