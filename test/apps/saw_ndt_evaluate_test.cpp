#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "real_data.h"
#include "report/gnuplot.h"
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

// The same drive as above in CSV, by names and in another order.
TEST_F(EvaluateApp, CsvIsTaken) {
  const std::string csv = file("est.csv",
                               "#timestamp [ns], p_x [m], p_y [m], p_z [m], q_w [], q_x [], q_y [], q_z []\n"
                               "0,9,9,0,1,0,0,0\n4000000000,1,3,0,1,0,0,0\n"
                               "5000000000,6,3,0,0.70710678118655,0,0,0.70710678118655\n");
  const AppResult expected = run(tum_reference + tum_estimate + "-json");
  EXPECT_EQ(run(tum_reference + csv + "-json").output, expected.output);
  EXPECT_NE(run(csv + kitti_estimate).errors.find("-times FILE"), std::string::npos);
  EXPECT_EQ(run(csv + kitti_estimate + times + calib).exit_code, 0);
}

// The estimate of each is the reference turned by a quarter to the left about the vertical and moved: the LiDAR's by
// (5, 6, 7), the camera's by (3, 4, 5). Its errors are (5, 6, 7), (4, 7, 7), (3, 8, 7) and (2, 7, 7) m for the LiDAR.
TEST_F(EvaluateApp, AlignmentTakesOffATransform) {
  const std::string tum =
      file("r.tum", "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n3 2 1 0 0 0 0 1\n") +
      file("e.tum",
           "0 5 6 7 0 0 0.70710678118655 0.70710678118655\n1 5 7 7 0 0 0.70710678118655 0.70710678118655\n"
           "2 5 8 7 0 0 0.70710678118655 0.70710678118655\n3 4 8 7 0 0 0.70710678118655 0.70710678118655\n");
  const std::string kitti =
      file("r.kitti",
           "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 1\n1 0 0 0 0 1 0 0 0 0 1 2\n1 0 0 1 0 1 0 0 0 0 1 2\n") +
      file("e.kitti",
           "0 0 1 3 0 1 0 4 -1 0 0 5\n0 0 1 4 0 1 0 4 -1 0 0 5\n0 0 1 5 0 1 0 4 -1 0 0 5\n0 0 1 5 0 1 0 4 -1 0 0 4\n");
  for (const std::string& files : {tum, kitti, kitti + calib}) {
    for (const std::string alignment : {"origin", "yaw", "se3"}) {
      SCOPED_TRACE(files + alignment);
      const AppResult result = run(files + "-skip 0 -json -align " + alignment);
      ASSERT_EQ(result.exit_code, 0) << result.errors;
      const auto report = nlohmann::json::parse(result.output);
      EXPECT_EQ(report.at("align"), alignment);
      EXPECT_EQ(report.at("evaluated_scans"), 4);
      EXPECT_NEAR(report.at("ate_rmse_m").get<double>(), 0.0, 1e-9);
      EXPECT_NEAR(report.at("yaw_p95_deg").get<double>(), 0.0, 1e-9);
      EXPECT_NEAR(report.at("ape_full").at("max").get<double>(), 0.0, 1e-9);
    }
  }
  const auto report = nlohmann::json::parse(run(tum + "-skip 0 -json").output);
  EXPECT_EQ(report.at("align"), "none");
  EXPECT_EQ(report.count("align_transform"), 0U);
  EXPECT_NEAR(report.at("ape_translation_m").at("sse").get<double>(), 110.0 + 114.0 + 122.0 + 102.0, 1e-9);
  EXPECT_NEAR(report.at("ape_translation_m").at("rmse").get<double>(), std::sqrt(112.0), 1e-9);
  EXPECT_NEAR(report.at("ape_translation_m").at("min").get<double>(), std::sqrt(102.0), 1e-9);
  EXPECT_NEAR(report.at("ape_rotation_deg").at("std").get<double>(), 0.0, 1e-6);
  EXPECT_NEAR(report.at("ape_rotation_deg").at("median").get<double>(), 90.0, 1e-9);
  EXPECT_NEAR(report.at("ape_full").at("max").get<double>(), std::sqrt(122.0 + 4.0), 1e-9);
  const auto aligned = nlohmann::json::parse(run(tum + "-skip 0 -json -align yaw").output).at("align_transform");
  EXPECT_NEAR(aligned.at("yaw_deg").get<double>(), -90.0, 1e-9);
  EXPECT_NEAR(aligned.at("x_m").get<double>(), -6.0, 1e-9);
  EXPECT_NEAR(aligned.at("y_m").get<double>(), 5.0, 1e-9);
}

// The estimate has stamps 0.5 s behind and twice as many poses: 0, 0, 1, 1, 2, 2, 3 m off the way of 2 m/s.
TEST_F(EvaluateApp, OffsetAndInterpolation) {
  const std::string files =
      file("r.tum", "10 0 0 0 0 0 0 1\n11 2 0 0 0 0 0 1\n12 4 0 0 0 0 0 1\n15 10 0 0 0 0 0 1\n") +
      file("e.tum",
           "9.5 0 0 0 0 0 0 1\n10 1 0 0 0 0 0 1\n10.5 2 1 0 0 0 0 1\n11 3 1 0 0 0 0 1\n11.5 4 2 0 0 0 0 1\n"
           "12 5 2 0 0 0 0 1\n12.5 6 3 0 0 0 0 1\n");
  const struct {
    std::string arguments;
    std::size_t evaluated;
    double share, mean_m, max_m;
  } cases[] = {
      {"-offset 0.5", 3, 3.0 / 7.0, 1.0, 2.0},
      {"-offset 0.499 -max-difference 0.002", 3, 3.0 / 7.0, 1.0, 2.0},
      {"-offset 0.5 -interpolate", 5, 5.0 / 7.0, 4.0 / 5.0, 2.0},
      {"-offset 0.5 -interpolate -longest-gap 3", 7, 1.0, 9.0 / 7.0, 3.0},
      {"-max-difference 0.01", 3, 3.0 / 7.0, 0.0, 0.0},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.arguments);
    const AppResult result = run(files + "-skip 0 -json " + c.arguments);
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const auto report = nlohmann::json::parse(result.output);
    EXPECT_EQ(report.at("evaluated_scans"), c.evaluated);
    EXPECT_EQ(report.at("estimate_poses"), 7);
    EXPECT_EQ(report.at("reference_poses"), 4);
    EXPECT_NEAR(report.at("paired_share").get<double>(), c.share, 1e-12);
    EXPECT_EQ(report.at("interpolated"), c.arguments.find("-interpolate") != std::string::npos);
    EXPECT_EQ(result.errors.empty(), c.share > 0.5) << result.errors;
    if (c.max_m == 0.0) continue;
    EXPECT_NEAR(report.at("position_mean_m").get<double>(), c.mean_m, 1e-9);
    EXPECT_NEAR(report.at("position_max_m").get<double>(), c.max_m, 1e-9);
  }
}

// The estimate goes 1.5 m a frame where the reference goes 1 m.
TEST_F(EvaluateApp, RelativeErrors) {
  std::string reference, estimate;
  for (int i = 0; i < 9; ++i) {
    reference += std::to_string(i) + ' ' + std::to_string(i) + " 0 0 0 0 0 1\n";
    estimate += std::to_string(i) + ' ' + std::to_string(1.5 * i) + " 0 0 0 0 0 1\n";
  }
  const std::string files = file("r.tum", reference) + file("e.tum", estimate) + "-skip 0 -json ";
  const auto reportOf = [&](const std::string& arguments) {
    const AppResult result = run(files + arguments);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return nlohmann::json::parse(result.output);
  };
  const auto frames = reportOf("-relative-frames 3");
  EXPECT_EQ(frames.count("rpe_metres"), 0U);
  EXPECT_EQ(frames.at("rpe_frames").at("delta"), 3);
  EXPECT_EQ(frames.at("rpe_frames").at("pairs"), 2);
  EXPECT_NEAR(frames.at("rpe_frames").at("translation_m").at("rmse").get<double>(), 1.5, 1e-12);
  EXPECT_NEAR(frames.at("rpe_frames").at("translation_m").at("sse").get<double>(), 4.5, 1e-12);
  EXPECT_NEAR(frames.at("rpe_frames").at("rotation_deg").at("max").get<double>(), 0.0, 1e-12);
  // 4 m are three steps of the estimate and four of the reference.
  const auto both = reportOf("-relative-frames 3 -relative-metres 4");
  EXPECT_EQ(both.at("rpe_frames"), frames.at("rpe_frames"));
  const auto metres = reportOf("-relative-metres 4").at("rpe_metres");
  EXPECT_EQ(metres.at("pairs"), 1);
  EXPECT_EQ(metres.at("way_of"), "estimate");
  EXPECT_NEAR(metres.at("translation_m").at("mean").get<double>(), 1.5, 1e-12);
  const auto of_reference = reportOf("-relative-metres 4 -way-of-reference").at("rpe_metres");
  EXPECT_EQ(of_reference.at("pairs"), 1);
  EXPECT_EQ(of_reference.at("way_of"), "reference");
  EXPECT_NEAR(of_reference.at("translation_m").at("mean").get<double>(), 2.0, 1e-12);
  // From every pose, 4.5 m is too far from 4 m.
  const auto all = reportOf("-relative-metres 4 -all-pairs -relative-tolerance 0.2").at("rpe_metres");
  EXPECT_EQ(all.at("pairs"), 6);
  EXPECT_EQ(all.at("all_pairs"), true);
  EXPECT_EQ(run(files + "-relative-metres 4 -all-pairs").exit_code, 1);
}

TEST_F(EvaluateApp, DrawsPictures) {
  if (!gnuplotFound()) GTEST_SKIP() << "gnuplot is not installed";
  const std::filesystem::path pictures = folder.path() / "new" / "pictures";
  const AppResult result = run(tum_reference + tum_estimate +
                               "-skip 0 -relative-frames 1 -relative-metres 0.5 -plot '" + pictures.string() + "'");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.errors, "");
  for (const std::string name :
       {"trajectories", "position_error", "yaw_error", "relative_error_frames", "relative_error_metres"}) {
    for (const std::string ending : {".png", ".svg"}) {
      EXPECT_GT(std::filesystem::file_size(pictures / (name + ending)), 1000U) << name << ending;
    }
  }
  // A single pose of no error has no extent.
  const std::string one = file("one.tum", "0 0 0 0 0 0 0 1\n");
  EXPECT_EQ(run(one + one + "-skip 0 -plot '" + (pictures / "one").string() + "'").errors, "");
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
  EXPECT_NE(result.output.find("align                     none\n"), std::string::npos) << result.output;
  EXPECT_NE(
      result.output.find("ape_translation_m         rmse 4.12311  mean 4  median 4  std 1  min 3  max 5  sse 34\n"),
      std::string::npos)
      << result.output;
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
      {tum_reference + tum_estimate + "-max-difference -1", 2, "-max-difference"},
      {tum_reference + tum_estimate + "-interpolate -longest-gap 0", 2, "-longest-gap"},
      {tum_reference + tum_estimate + "-longest-gap 2", 2, "-longest-gap"},
      {tum_reference + tum_estimate + "-interpolate -max-difference 1", 2, "exclude each other"},
      {tum_reference + tum_estimate + "-all-pairs", 2, "-all-pairs"},
      {tum_reference + tum_estimate + "-relative-frames 1.5", 2, "-relative-frames: delta = 1.5"},
      {tum_reference + tum_estimate + "-relative-metres -1", 2, "-relative-metres: delta = -1"},
      {tum_reference + tum_estimate + "-relative-metres 50", 1, "no two of the 2 poses are 50 m apart"},
      {tum_reference + tum_estimate + "-align sim3", 2, "-align"},
      {tum_reference + tum_estimate + "-align se3", 1, "the 2 pairs are the same or on one line"},
      {kitti_reference + kitti_estimate + "-offset 1", 2, "-times FILE"},
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
