#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "drive_files.h"
#include "real_data.h"
#include "saw_ndt/drives/kitti_sequence.h"

namespace saw_ndt {
namespace {

class LocalizeApp : public DriveFiles {
 protected:
  void buildMap(const std::string& options = "") const {
    const AppResult result =
        runAppProgram(SAW_NDT_BUILD_MAP_APP, quoted(drive_folder) + quoted(map_file) + kSensor + options);
    ASSERT_EQ(result.exit_code, 0) << result.errors;
  }
  std::string files() const { return quoted(drive_folder) + quoted(map_file) + quoted(out) + kSensor; }
  AppResult localize(const std::string& options) const { return runAppProgram(SAW_NDT_APP, files() + options); }
  void expectLocalizeFails(int exit_code, std::initializer_list<std::string> parts,
                           const std::string& more = "") const {
    expectFails(SAW_NDT_APP, files() + "-skip 0 " + more, exit_code, parts);
  }

  nlohmann::json summary() const { return nlohmann::json::parse(contentOf(out / "summary.json")); }
  std::vector<std::string> frames() const {
    std::istringstream stream(contentOf(out / "frames.csv"));
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
  }

  /// What saw_ndt_evaluate says of a trajectory, its -skip being 0.
  static nlohmann::json evaluated(const std::filesystem::path& reference, const std::filesystem::path& estimate,
                                  const std::string& more) {
    const AppResult result =
        runAppProgram(SAW_NDT_EVALUATE_APP, quoted(reference) + quoted(estimate) + "-json -skip 0 -threads 1 " + more);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return nlohmann::json::parse(result.output);
  }

  /// Expects that both trajectories, compared with the reference poses of the scans by saw_ndt_evaluate, give the
  /// errors of the summary.
  void expectEvaluatedAlike(const KittiSequence& sequence, const std::vector<int>& scans) const {
    std::vector<Eigen::Isometry3d> references;
    std::ofstream times(folder.path() / "some_times.txt");
    times.precision(17);
    for (const int scan : scans) {
      const auto i = static_cast<std::size_t>(scan);
      references.push_back(cameraPose(sequence.posesLidar()[i], sequence.T_camera_lidar()));
      times << sequence.stamps()[i] << '\n';
    }
    times.close();
    writeKittiTrajectory(folder.path() / "some_poses.txt", references);
    const std::string more =
        "-times " + quoted(folder.path() / "some_times.txt") + "-calib " + quoted(sequence.folder() / "calib.txt");
    const nlohmann::json expected = summary();
    for (const std::string estimate : {"trajectory_tum.txt", "trajectory_kitti.txt"}) {
      const nlohmann::json report = evaluated(folder.path() / "some_poses.txt", out / estimate, more);
      EXPECT_EQ(report.at("evaluated_scans"), expected.at("evaluated_scans"));
      for (const std::string field : {"ate_rmse_m", "position_p95_m", "position_max_m", "yaw_mae_deg", "yaw_p95_deg"}) {
        EXPECT_NEAR(report.at(field).get<double>(), expected.at(field).get<double>(), 1e-7) << estimate << ' ' << field;
      }
    }
  }

  const std::filesystem::path map_file = folder.path() / "a.map";
  const std::filesystem::path out = folder.path() / "results" / "run 1";
};

TEST_F(LocalizeApp, WritesWhatTheContractSays) {
  buildMap("-scans ::2");
  const AppResult result = localize("-skip 0");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(withoutSetup(result.errors), "");
  EXPECT_EQ(result.output, contentOf(out / "summary.json"));
  EXPECT_EQ(filesIn(out).size(), 4U);

  const nlohmann::json json = summary();
  EXPECT_EQ(json.at("method"), "weighted");
  EXPECT_EQ(json.at("scans"), 6);
  EXPECT_EQ(json.at("accepted"), 6);
  EXPECT_EQ(json.at("rejected"), 0);
  EXPECT_EQ(json.at("threads"), 1);
  for (const std::string stage : {"total_ms", "align_ms", "segment_ms"}) {
    for (const std::string figure : {"mean", "p50", "p95", "max"}) EXPECT_GT(json.at(stage).at(figure), 0.0);
  }
  for (const std::string field : {"source_points_mean", "peak_rss_mb", "ate_rmse_m", "position_p95_m", "position_max_m",
                                  "yaw_mae_deg", "yaw_p95_deg"}) {
    EXPECT_GT(json.at(field), 0.0) << field;
  }
  EXPECT_EQ(json.at("evaluated_scans"), 6);
  EXPECT_LT(json.at("position_max_m"), 0.03);

  const std::vector<std::string> lines = frames();
  ASSERT_EQ(lines.size(), 7U);
  const std::string header =
      "scan,stamp,accepted,reason,converged,iterations,likelihood,correction_m,correction_deg,source_points,"
      "segment_ms,filter_ms,align_ms,total_ms";
  EXPECT_EQ(lines[0].substr(0, header.size()), header);
  EXPECT_TRUE(lines[0].size() == header.size() || lines[0][header.size()] == ',');
  const auto commas = [](const std::string& line) { return std::count(line.begin(), line.end(), ','); };
  for (std::size_t i = 1; i < lines.size(); ++i) {
    EXPECT_EQ(commas(lines[i]), commas(lines[0]));
    const std::string scan = std::to_string(i - 1);
    EXPECT_EQ(lines[i].rfind(scan + ",0." + scan + "00000000,1,accepted,1,", 0), 0U) << lines[i];
  }
  EXPECT_EQ(readTumTrajectory(out / "trajectory_tum.txt").size(), 6U);
  EXPECT_EQ(readKittiTrajectory(out / "trajectory_kitti.txt").size(), 6U);
  expectEvaluatedAlike(KittiSequence(drive_folder), {0, 1, 2, 3, 4, 5});
}

TEST_F(LocalizeApp, RejectedScansAreListedWithTheirReason) {
  buildMap();
  const AppResult result = localize("-skip 0 -min-likelihood 50");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.errors.find("lost at scan 2"), std::string::npos) << result.errors;
  EXPECT_EQ(summary().at("rejected"), 6);
  EXPECT_NE(frames()[6].find("5,0.500000000,0,low likelihood,1,"), std::string::npos) << frames()[6];
}

TEST_F(LocalizeApp, AnInitialPoseStandsInForTheReference) {
  buildMap();
  ASSERT_EQ(localize("-scans 2: -skip 0 -method classical").exit_code, 0);
  const auto expected = readTumTrajectory(out / "trajectory_tum.txt");
  const std::string found = "-initial-pose 1.1,0.1,-0.1,0,0.5,2 -method classical ";
  std::filesystem::remove(drive_folder / "poses.txt");
  expectLocalizeFails(2, {"drive", "-initial-pose"});
  ASSERT_EQ(localize("-scans 2: " + found).exit_code, 0);
  EXPECT_FALSE(summary().contains("ate_rmse_m"));
  EXPECT_EQ(summary().at("accepted"), 4);
  const auto got = readTumTrajectory(out / "trajectory_tum.txt");
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t i = 0; i < got.size(); ++i) {
    EXPECT_EQ(got[i].stamp_s, expected[i].stamp_s);
    EXPECT_LT((got[i].T_map_body.translation() - expected[i].T_map_body.translation()).norm(), 0.005);
  }
  // The calibration is missed before the work, not after it.
  std::filesystem::remove(drive_folder / "calib.txt");
  expectLocalizeFails(1, {"calib.txt: No such file"}, found);
}

TEST_F(LocalizeApp, AnUnknownStartIsFound) {
  buildMap();
  ASSERT_EQ(localize("-skip 0 ").exit_code, 0);
  const auto expected = readTumTrajectory(out / "trajectory_tum.txt");
  for (const std::string start : {"-initial-pose unknown ", "-initial-pose 1,-2,0,0,0,120 -initial-yaw-range 180 "}) {
    SCOPED_TRACE(start);
    ASSERT_EQ(localize("-skip 0 " + start).exit_code, 0);
    EXPECT_EQ(summary().at("accepted"), 6);
    EXPECT_LT(summary().at("position_max_m"), 0.03);
    EXPECT_EQ(frames()[0].substr(frames()[0].rfind(',')), ",search");
    EXPECT_NE(frames()[1].substr(frames()[1].rfind(',')), ",");
    EXPECT_EQ(frames()[6].substr(frames()[6].rfind(',')), ",");
    const auto got = readTumTrajectory(out / "trajectory_tum.txt");
    ASSERT_EQ(got.size(), expected.size());
    // The first scan ends within the epsilon of 1 mm of the same pose.
    EXPECT_LT((got[5].T_map_body.translation() - expected[5].T_map_body.translation()).norm(), 0.002);
  }
  // Nothing is known of scans before the first that is found: they have no pose.
  ASSERT_EQ(localize("-skip 0 -initial-pose unknown -min-likelihood 50").exit_code, 1);
  EXPECT_TRUE(contentOf(out / "trajectory_tum.txt").empty());
  EXPECT_EQ(summary().at("states").at("relocalizing").at("scans"), 6);
  EXPECT_EQ(frames().size(), 7U);
}

TEST_F(LocalizeApp, OdometryAndPositionsAreTaken) {
  buildMap();
  const KittiSequence sequence(drive_folder);
  std::vector<StampedPose> odometry;
  std::ofstream gnss(folder.path() / "gnss.csv");
  gnss << "stamp_s,x_m,y_m,z_m,sigma_x_m,sigma_y_m,sigma_z_m\n";
  for (std::size_t i = 0; i < 6; ++i) {
    const Eigen::Isometry3d& T = sequence.posesLidar()[i];
    odometry.push_back({sequence.stamps()[i], T});
    const Eigen::Vector3d position = T.translation() + Eigen::Vector3d(i == 2 ? 40.0 : 1.0, -1.0, 0.5);
    gnss << sequence.stamps()[i] << ',' << position.x() << ',' << position.y() << ',' << position.z() << ",2,2,2\n";
  }
  gnss.close();
  writeTumTrajectory(folder.path() / "odometry.txt", odometry);
  const std::string odometry_option = "-odometry " + quoted(folder.path() / "odometry.txt");
  const std::string gnss_option = "-gnss " + quoted(folder.path() / "gnss.csv");
  for (const std::string& options :
       {odometry_option, gnss_option, odometry_option + gnss_option + "-initial-pose unknown "}) {
    ASSERT_EQ(localize("-skip 0 " + options).exit_code, 0) << options;
    EXPECT_EQ(summary().at("accepted"), 6);
    EXPECT_LT(summary().at("position_max_m"), 0.03);
  }
  expectLocalizeFails(1, {"nowhere.txt"}, "-odometry nowhere.txt");
  expectLocalizeFails(1, {"times.txt: line 1"}, "-gnss " + quoted(drive_folder / "times.txt"));
  expectLocalizeFails(2, {"gnss-sigma"}, gnss_option + "-gnss-sigma 0");
}

TEST_F(LocalizeApp, AMountedLidar) {
  buildMap();
  ASSERT_EQ(localize("-skip 0 -base-lidar 1,0.2,1.7,1,2,30").exit_code, 0);
  EXPECT_EQ(summary().at("accepted"), 6);
  EXPECT_LT(summary().at("position_max_m"), 0.03);
  // The camera's trajectory does not depend on where the base is.
  const std::string kitti = quoted(out / "trajectory_kitti.txt");
  const nlohmann::json report = evaluated(drive_folder / "poses.txt", out / "trajectory_kitti.txt",
                                          "-calib " + quoted(drive_folder / "calib.txt"));
  EXPECT_LT(report.at("position_max_m"), 0.03);
}

TEST_F(LocalizeApp, ADriveShorterThanTheSkippedStartIsLocalizedWithoutErrors) {
  buildMap();
  const AppResult result = localize("");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.errors.find("-skip 3"), std::string::npos) << result.errors;
  EXPECT_EQ(summary().at("accepted"), 6);
  EXPECT_FALSE(summary().contains("ate_rmse_m"));
}

TEST_F(LocalizeApp, WrongUsageIsNamed) {
  buildMap();
  expectLocalizeFails(2, {"-method", "best", "classical"}, "-method best");
  expectLocalizeFails(2, {"source_voxel_size_m = -0.2"}, "-source-voxel -0.2");
  expectLocalizeFails(2, {"max_iterations = 0"}, "-max-iterations 0");
  expectLocalizeFails(2, {"max_correction_m = 0"}, "-max-correction 0");
  expectLocalizeFails(2, {"-initial-pose", "'1,2,3'"}, "-initial-pose 1,2,3");
  expectLocalizeFails(2, {"-initial-pose", "'x'", "finite number"}, "-initial-pose 1,2,3,4,5,x");
  expectLocalizeFails(2, {"-initial-pose unknown", "-no-search"}, "-initial-pose unknown -no-search");
  expectLocalizeFails(2, {"initial-yaw-range", "181"}, "-initial-yaw-range 181");
  expectLocalizeFails(2, {"initial-radius"}, "-initial-radius 0");
  expectLocalizeFails(2, {"search_budget_ms = 0"}, "-search-budget 0");
  expectLocalizeFails(2, {"scan selection '9'"}, "-scans 9");
  expectFails(SAW_NDT_APP, files() + "-skip -1", 2, {"-skip"});
  expectFails(SAW_NDT_APP, quoted(drive_folder) + quoted(map_file), 2, {"missing OUT_DIR"});
}

TEST_F(LocalizeApp, BadMapsAreNamed) {
  expectLocalizeFails(1, {"a.map: No such file"});
  buildMap("-classical");
  expectLocalizeFails(1, {"a.map: ", "-classical", "weighted-s50"}, "-method weighted-s50");
  buildMap("-scans 0");
  const std::string good = contentOf(map_file);
  const auto refused = [&](const std::string& bytes, std::initializer_list<std::string> parts) {
    folder.write("a.map", bytes);
    expectLocalizeFails(1, parts);
  };
  std::string other = good;
  other[8] = 9;
  refused(other, {"a.map: offset 8: map version 9"});
  other = good;
  other[good.size() / 2] = static_cast<char>(other[good.size() / 2] ^ 1);
  refused(other, {"a.map: offset ", "damaged"});
  refused(good.substr(0, good.size() - 5), {"a.map: offset ", "truncated"});
  refused(good.substr(0, 5), {"a.map: offset 0: not a saw_ndt map"});
  refused("", {"a.map: offset 0: not a saw_ndt map"});
  refused(contentOf(drive_folder / "velodyne" / "000000.bin"), {"a.map: offset 0: not a saw_ndt map"});
}

TEST_F(LocalizeApp, BadDrivesAreNamedAndNothingStaysBehind) {
  buildMap("-scans 0");
  const std::string poses = contentOf(drive_folder / "poses.txt"), calib = contentOf(drive_folder / "calib.txt");
  replace("poses.txt", poses.substr(0, poses.find('\n') + 1));
  expectLocalizeFails(1, {"poses.txt: 1 poses", "6"});
  replace("poses.txt", poses);
  replace("times.txt", "0\n0.1\n0.2\n");
  expectLocalizeFails(1, {"times.txt: 3 times", "6"});
  std::filesystem::remove(drive_folder / "times.txt");
  expectLocalizeFails(1, {"times.txt: No such file"});
  replace("times.txt", "0\n0.1\n0.2\n0.3\n0.4\n0.5\n");
  replace("calib.txt", "P0: 1 0 0 0 0 1 0 0 0 0 1 0\n");
  expectLocalizeFails(1, {"calib.txt: no line Tr"});
  replace("calib.txt", calib);
  expectFails(SAW_NDT_APP, quoted(folder.path()) + quoted(map_file) + quoted(out), 1, {"holds no recording"});
}

TEST_F(LocalizeApp, AScanThatCannotBeReadIsRejectedAndTheOthersAreLocalized) {
  buildMap("");
  const std::string scan = contentOf(drive_folder / "velodyne" / "000003.bin");
  const std::pair<std::string, std::string> damages[] = {{scan.substr(0, 1003), "000003.bin: offset 992"},
                                                         {"", "000003.bin: offset 0: the file is empty"}};
  for (const auto& [content, reason] : damages) {
    replace("velodyne/000003.bin", content);
    const AppResult result = localize("-skip 0");
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_NE(result.errors.find(reason), std::string::npos) << result.errors;
    const auto json = nlohmann::json::parse(result.output);
    EXPECT_EQ(json.at("accepted"), 5);
    EXPECT_EQ(json.at("rejected"), 1);
    EXPECT_LT(json.at("position_max_m"), 0.1);
    const std::string frames = contentOf(out / "frames.csv");
    EXPECT_NE(frames.find(",0,unreadable scan,"), std::string::npos) << frames;
    EXPECT_NE(frames.find(",000003.bin,coasting,"), std::string::npos) << frames;
    std::filesystem::remove_all(out);
    const AppResult strict = localize("-skip 0 -strict");
    EXPECT_EQ(strict.exit_code, 1);
    EXPECT_NE(strict.errors.find("1 scans could not be read"), std::string::npos) << strict.errors;
    EXPECT_EQ(summary().at("accepted"), 5);
  }
  replace("velodyne/000003.bin", scan);
  EXPECT_EQ(localize("-skip 0 -strict").exit_code, 0);
}

TEST_F(LocalizeApp, OddStampsAreSaid) {
  buildMap("");
  const std::pair<std::string, std::string> cases[] = {
      {"0\n0\n0.1\n0.1\n0.2\n0.2\n", "3 of 6 stamps equal the one before"},
      {"0\n1e8\n2e8\n3e8\n4e8\n5e8\n", "nanoseconds: divide them by 1e9"}};
  for (const auto& [times, said] : cases) {
    replace("times.txt", times);
    const AppResult result = localize("-skip 0");
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_NE(result.errors.find("saw_ndt_localize: warning: "), std::string::npos) << result.errors;
    EXPECT_NE(result.errors.find("times.txt: "), std::string::npos) << result.errors;
    EXPECT_NE(result.errors.find(said), std::string::npos) << result.errors;
    // Errors are of the poses of the same scan, whatever its stamp.
    EXPECT_EQ(summary().at("evaluated_scans"), 6);
    EXPECT_LT(summary().at("position_max_m"), 0.1);
  }
}

TEST_F(LocalizeApp, ALocalizerOfOtherSegmentationIsRefusedUnlessAllowed) {
  buildMap("");
  const std::string other = "-ground-rule inclination ";
  expectLocalizeFails(1, {"segmentation.ground.rule = inclination", "growing"}, other);
  const AppResult result = localize("-skip 0 -allow-other-segmentation " + other);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
}

TEST_F(LocalizeApp, WhatIsNotStatedOfTheGroundIsAsForTheMap) {
  for (const std::string options : {"-ground-rule inclination", "-slope-deg 14"}) {
    buildMap(options);
    const AppResult result = localize("-skip 0");
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(summary().at("accepted"), 6);
    EXPECT_EQ(localize("-skip 0 " + options).exit_code, 0);
  }
  const AppResult result = localize("-skip 0 -slope-deg 12");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.errors.find("segmentation.ground.slope_deg = 12"), std::string::npos) << result.errors;
}

TEST_F(LocalizeApp, TheLidarMayBeMountedInAnotherWayThanForTheMap) {
  buildMap();
  // The same drive by a LiDAR that hangs upside down.
  const Eigen::Isometry3d T_upright_hanging(Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX()));
  SyntheticDrive drive = driveDownTheStreet(SensorModel::named("VLP-16"), 6);
  for (Eigen::Isometry3d& T : drive.T_map_lidar) T = T * T_upright_hanging;
  for (std::vector<LidarPoint>& scan : drive.scans) {
    for (LidarPoint& point : scan) {
      point.y = -point.y;
      point.z = -point.z;
    }
  }
  writeKittiDrive(drive_folder, drive);
  for (const std::string options : {"", "-mounting stated -mounting-roll-deg 180", "-base-lidar 0,0,1.7,180,0,0"}) {
    const AppResult result = localize("-skip 0 " + options);
    EXPECT_EQ(result.exit_code, 0) << options << result.errors;
    EXPECT_EQ(result.errors.find("warning"), std::string::npos) << result.errors;
    EXPECT_EQ(summary().at("accepted"), 6) << options;
    EXPECT_LT(summary().at("position_max_m"), 0.03) << options;
  }
}

TEST_F(LocalizeApp, OutputsThatCannotBeWrittenAreNamed) {
  buildMap("-scans 0");
  const auto refused = [&](const std::filesystem::path& to, std::initializer_list<std::string> parts) {
    expectFails(SAW_NDT_APP, quoted(drive_folder) + quoted(map_file) + quoted(to) + kSensor + "-skip 0", 1, parts);
  };
  refused(map_file, {"a.map: "});
  refused(map_file / "below" / "it", {"it: ", "Not a directory"});
  refused("/proc/nowhere", {"/proc/nowhere: "});
  // Results of an earlier run stay together where one of the new ones cannot take its place.
  folder.write("old/trajectory_tum.txt", "earlier");
  std::filesystem::create_directories(folder.path() / "old" / "summary.json");
  refused(folder.path() / "old", {"summary.json: "});
}

TEST_F(LocalizeApp, RealTrajectoriesAreEvaluatedAlike) {
  if (realDataFolder().empty()) GTEST_SKIP() << "no real scans: set SAW_NDT_DATA to their folder";
  const KittiSequence sequence(realDataFolder() / "kitti" / "sequences" / "00");
  const std::string real = quoted(sequence.folder()) + quoted(map_file);
  const AppResult built = runAppProgram(SAW_NDT_BUILD_MAP_APP, real + "-scans 0:10:2");
  ASSERT_EQ(built.exit_code, 0) << built.errors;
  const AppResult result = runAppProgram(SAW_NDT_APP, real + quoted(out) + "-scans 1:10:2 -skip 0");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  expectEvaluatedAlike(sequence, {1, 3, 5, 7, 9});
}

/// Drives of a LiDAR that moves 2 m a turn, and a map of scans without skew.
class SkewedDrive : public LocalizeApp {
 protected:
  SkewedDrive() {
    const SensorModel sensor = SensorModel::named("VLP-16");
    raw = raceDownTheStreet(sensor, 14, 20.0, 0.1, 100);
    writeKittiDrive(raw_folder, raw);
    writeKittiDrive(even_folder, raceDownTheStreet(sensor, 14, 20.0, 0.0, 1));
    const AppResult built = runAppProgram(SAW_NDT_BUILD_MAP_APP, quoted(even_folder) + quoted(map_file) + kSensor);
    EXPECT_EQ(built.exit_code, 0) << built.errors;
    EXPECT_NE(built.output.find("\nmotion compensation off: "), std::string::npos) << built.output;
  }
  AppResult localizeIn(const std::filesystem::path& drive, const std::string& more = "") const {
    return runAppProgram(SAW_NDT_APP, quoted(drive) + quoted(map_file) + quoted(out) + kSensor + "-skip 0 " + more);
  }

  const std::filesystem::path raw_folder = folder.path() / "raw", even_folder = folder.path() / "even";
  SyntheticDrive raw;
};

TEST_F(SkewedDrive, AutoFindsOutAndRecordsIt) {
  ASSERT_EQ(localizeIn(raw_folder).exit_code, 0);
  nlohmann::json json = summary();
  EXPECT_EQ(json.at("motion_compensation"), "counterclockwise");
  EXPECT_NE(json.at("motion_compensation_reason").get<std::string>().find(" as they are"), std::string::npos);
  EXPECT_EQ(json.at("accepted"), 14);
  EXPECT_LT(json.at("ate_rmse_m"), 0.03);

  ASSERT_EQ(localizeIn(even_folder).exit_code, 0);
  EXPECT_EQ(summary().at("motion_compensation"), "off");
  const std::string poses = contentOf(out / "trajectory_tum.txt");
  ASSERT_EQ(localizeIn(even_folder, "-motion-compensation off").exit_code, 0);
  EXPECT_EQ(contentOf(out / "trajectory_tum.txt"), poses);
  EXPECT_EQ(summary().at("motion_compensation_reason"), "as stated");
}

TEST_F(SkewedDrive, SaysWhereScansLookSkewedOrHaveNoTimes) {
  const AppResult no_times = localizeIn(raw_folder, "-motion-compensation times");
  EXPECT_NE(no_times.errors.find("warning: -motion-compensation times"), std::string::npos) << no_times.errors;
  for (std::size_t i = 0; i < raw.scans.size(); ++i) {
    std::ostringstream bytes, name;
    for (std::size_t k = 0; k < raw.scans[i].size(); ++k) {
      const LidarPoint& p = raw.scans[i][k];
      const float values[] = {p.x, p.y, p.z, p.intensity, static_cast<float>(raw.times_s[i][k])};
      bytes.write(reinterpret_cast<const char*>(values), sizeof values);
    }
    name << std::setfill('0') << std::setw(6) << i << ".bin";
    std::ofstream(raw_folder / "velodyne" / name.str(), std::ios::binary) << bytes.str();
  }
  const AppResult off = localizeIn(raw_folder, "-bin-fields 5 -motion-compensation off");
  EXPECT_NE(off.errors.find("warning: -motion-compensation off, but scans look skewed"), std::string::npos)
      << off.errors;
  ASSERT_EQ(localizeIn(raw_folder, "-bin-fields 5").exit_code, 0);
  EXPECT_EQ(summary().at("motion_compensation"), "times");
  EXPECT_EQ(summary().at("accepted"), 14);
  const AppResult map =
      runAppProgram(SAW_NDT_BUILD_MAP_APP, quoted(raw_folder) + quoted(map_file) + kSensor + "-bin-fields 5");
  EXPECT_NE(map.output.find("motion compensation times: "), std::string::npos) << map.output << map.errors;
}

}  // namespace
}  // namespace saw_ndt
