#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "real_data.h"
#include "run_app_program.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/io/trajectory.h"

namespace saw_ndt {
namespace {

class EvaluateApp : public ::testing::Test {
 protected:
  AppResult run(const std::string& arguments) const { return runAppProgram(SAW_NDT_APP, "-threads 1 " + arguments); }
  std::string file(const std::string& name, const std::string& content) const {
    return "'" + folder.write(name, content).string() + "' ";
  }

  TemporaryFolder folder;
  // Three poses along x; the estimate is 3 and 5 m off, the last one also 90 degrees of yaw.
  std::string tum_reference = file("ref.tum", "0 0 0 0 0 0 0 1\n4 1 0 0 0 0 0 1\n5 2 0 0 0 0 0 1\n");
  std::string tum_estimate =
      file("est.tum", "0 9 9 0 0 0 0 1\n4 1 3 0 0 0 0 1\n5 6 3 0 0 0 0.70710678118655 0.70710678118655\n");
  // The same as poses of a camera: x right, y down, z forward; the LiDAR's x is the camera's z.
  std::string kitti_reference =
      file("ref.kitti", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 1\n1 0 0 0 0 1 0 0 0 0 1 2\n");
  std::string kitti_estimate =
      file("est.kitti", "1 0 0 -9 0 1 0 0 0 0 1 9\n1 0 0 -3 0 1 0 0 0 0 1 1\n0 0 -1 -3 0 1 0 0 1 0 0 6\n");
  std::string times = "-times " + file("times.txt", "0\n4\n5\n");
  std::string calib = "-calib " + file("calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
};

TEST_F(EvaluateApp, KnownErrors) {
  for (const std::string& files :
       {tum_reference + tum_estimate, kitti_reference + kitti_estimate + times,
        kitti_reference + kitti_estimate + times + calib, kitti_reference + tum_estimate + times + calib,
        tum_reference + kitti_estimate + times + calib}) {
    SCOPED_TRACE(files);
    const AppResult result = run(files + "-json");
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const auto report = nlohmann::json::parse(result.output);
    EXPECT_EQ(report.at("evaluated_scans"), 2);
    EXPECT_NEAR(report.at("ate_rmse_m").get<double>(), std::sqrt(17.0), 1e-9);
    EXPECT_NEAR(report.at("position_p95_m").get<double>(), 4.9, 1e-9);
    EXPECT_NEAR(report.at("position_max_m").get<double>(), 5.0, 1e-9);
    EXPECT_NEAR(report.at("yaw_mae_deg").get<double>(), 45.0, 1e-9);
    EXPECT_NEAR(report.at("yaw_p95_deg").get<double>(), 85.5, 1e-9);
  }
}

// The absolute pose error of evo (evo_ape tum / kitti, translation part, without alignment) is the distance
// |t_reference - t_estimate| of poses whose stamps are at most 0.01 s apart. Here 5, 0 and 3 m: mean 8/3, median 3,
// rmse sqrt((25 + 0 + 9) / 3), max 5, and standard deviation sqrt(34/3 - 64/9) = sqrt(38)/3.
TEST_F(EvaluateApp, AgreesWithEvosAbsolutePoseError) {
  const std::string tum_files =
      file("a.tum", "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n3 3 0 0 0 0 0 1\n4 4 0 0 0 0 0 1\n") +
      file("b.tum",
           "0.004 3 4 0 0 0 0 1\n1.009 1 0 0 0 0 0 1\n2.5 9 9 9 0 0 0 1\n2.995 4 2 2 0 0 0 1\n4.02 9 9 9 0 0 0 1\n");
  const std::string kitti_files =
      file("a.kitti", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 1\n1 0 0 0 0 1 0 0 0 0 1 3\n") +
      file("b.kitti", "1 0 0 3 0 1 0 4 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 1\n1 0 0 2 0 1 0 -2 0 0 1 4\n");
  for (const std::string& files : {tum_files, kitti_files, kitti_files + calib}) {
    SCOPED_TRACE(files);
    const AppResult result = run(files + "-json -skip 0");
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const auto report = nlohmann::json::parse(result.output);
    const double rmse_m = report.at("ate_rmse_m"), mean_m = report.at("position_mean_m");
    EXPECT_EQ(report.at("evaluated_scans"), 3);
    EXPECT_NEAR(rmse_m, 3.366501646120693, 1e-9);
    EXPECT_NEAR(mean_m, 2.666666666666667, 1e-9);
    EXPECT_NEAR(std::sqrt(rmse_m * rmse_m - mean_m * mean_m), 2.054804667656325, 1e-9);
    EXPECT_NEAR(report.at("position_median_m").get<double>(), 3.0, 1e-9);
    EXPECT_NEAR(report.at("position_max_m").get<double>(), 5.0, 1e-9);
  }
}

TEST_F(EvaluateApp, OddStampsAreSaid) {
  std::string seconds, nanoseconds, equal, rounded, standing, falling;
  for (int i = 0; i < 8; ++i) {
    const std::string pose = ' ' + std::to_string(i) + " 0 0 0 0 0 1\n";
    const std::string at_origin = " 0 0 0 0 0 0 1\n";
    seconds += "100." + std::to_string(i) + pose;
    nanoseconds += std::to_string(i) + "00000000" + pose;
    equal += "100." + std::to_string(i == 4 ? 3 : i) + pose;
    rounded += "100." + std::to_string(i / 2) + pose;
    standing += "100." + std::to_string(i == 4 ? 3 : i) + at_origin;
    falling += "100." + std::to_string(7 - i) + pose;
  }
  const struct {
    std::string content;
    int exit_code;
    std::vector<std::string> errors;
  } cases[] = {
      {seconds, 0, {}},
      {nanoseconds, 0, {": warning: ", "a.tum: ", "nanoseconds: divide them by 1e9"}},
      {equal, 1, {": warning: ", "1 of 8 stamps equal", "which one is meant cannot be told"}},
      {rounded, 1, {": warning: ", "seem to be rounded", "which one is meant cannot be told"}},
      {standing, 0, {": warning: ", "1 of 8 stamps equal"}},
      {falling, 0, {": warning: ", "7 of 8 stamps lie before"}},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.content);
    const std::string path = file("a.tum", c.content);
    const AppResult result = run(path + path + "-skip 0 -json");
    EXPECT_EQ(result.exit_code, c.exit_code);
    EXPECT_EQ(result.errors.empty(), c.errors.empty()) << result.errors;
    EXPECT_EQ(result.output.empty(), c.exit_code != 0);
    if (c.exit_code == 0) {
      EXPECT_EQ(nlohmann::json::parse(result.output).at("position_max_m"), 0.0);
    }
    for (const std::string& part : c.errors) EXPECT_NE(result.errors.find(part), std::string::npos) << result.errors;
  }
  // As many as one of two is enough.
  const std::string all = file("all.tum", seconds);
  const std::string few = file("few.tum", "100.1 1 0 0 0 0 0 1\n100.2 2 0 0 0 0 0 1\n100.6 6 0 0 0 0 0 1\n");
  const AppResult sparse = run(few + all + "-skip 0");
  EXPECT_EQ(sparse.exit_code, 0);
  EXPECT_NE(sparse.errors.find("only 3 of 8 poses"), std::string::npos) << sparse.errors;
  EXPECT_EQ(run(all + few + "-skip 0").errors, "");
}

TEST_F(EvaluateApp, PrintsText) {
  const AppResult result = run(tum_reference + tum_estimate);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("evaluated_scans           2\n"), std::string::npos) << result.output;
}

TEST_F(EvaluateApp, KittiFilesAloneAreComparedLineByLine) {
  const AppResult result = run(kitti_reference + kitti_estimate + "-json -skip 0.1");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(nlohmann::json::parse(result.output).at("evaluated_scans"), 2);
}

TEST_F(EvaluateApp, SaysWhatIsWrong) {
  const std::string shorter = file("short.kitti", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  const struct {
    std::string arguments;
    int exit_code;
    std::string reason;
  } cases[] = {
      {tum_reference, 2, "missing ESTIMATE"},
      {tum_reference + tum_estimate + "-skip -1", 2, "-skip"},
      {kitti_reference + tum_estimate, 2, "-times FILE"},
      {kitti_reference + tum_estimate + times, 2, "-calib FILE"},
      {kitti_reference + shorter, 1, "short.kitti: 1 poses, where"},
      {kitti_reference + kitti_estimate + "-times " + file("two.txt", "0\n1\n"), 1, "two.txt: 2 times"},
      {tum_reference + tum_estimate + "-skip 100", 1, "within the first 100 s"},
      {tum_reference + "none.tum", 1, "none.tum: No such file"},
      {tum_reference + file("bad.tum", "0 0 0 0 0 0 0 1\n1 2\n"), 1, "bad.tum: line 2"},
  };
  for (const auto& c : cases) {
    const AppResult result = run(c.arguments);
    EXPECT_EQ(result.exit_code, c.exit_code) << c.arguments;
    EXPECT_NE(result.errors.find(c.reason), std::string::npos) << result.errors;
    EXPECT_EQ(result.output, "");
  }
}

TEST_F(EvaluateApp, AFullDiskIsAFailure) {
  const AppResult result = runAppProgram(SAW_NDT_APP, tum_reference + tum_estimate, "/dev/full");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.errors.find("standard output"), std::string::npos) << result.errors;
}

TEST_F(EvaluateApp, RealReferenceInBothFormatsAgrees) {
  const std::filesystem::path kitti = realDataFolder() / "kitti";
  if (!std::filesystem::exists(kitti)) GTEST_SKIP() << "no real data at " << kitti;
  const KittiSequence sequence(kitti / "sequences" / "drive_0005");
  const std::vector<double> stamps_s = sequence.stamps();
  const std::vector<Eigen::Isometry3d> poses = sequence.posesLidar();
  std::vector<StampedPose> odd_scans;
  for (std::size_t i = 1; i < poses.size(); i += 2) odd_scans.push_back({stamps_s[i], poses[i]});
  const auto estimate = folder.path() / "odd.txt";
  writeTumTrajectory(estimate, odd_scans);
  const AppResult result =
      run("'" + sequence.posesFile().string() + "' '" + estimate.string() + "' -json -times '" +
          (sequence.folder() / "times.txt").string() + "' -calib '" + (sequence.folder() / "calib.txt").string() + "'");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const auto report = nlohmann::json::parse(result.output);
  EXPECT_EQ(report.at("evaluated_scans"), 20);
  EXPECT_LT(report.at("position_max_m").get<double>(), 1e-6);
  EXPECT_LT(report.at("yaw_p95_deg").get<double>(), 1e-6);
}

}  // namespace
}  // namespace saw_ndt
