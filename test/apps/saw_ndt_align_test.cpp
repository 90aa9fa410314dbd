#include <gtest/gtest.h>
#include <pcl/common/transforms.h>

#include <nlohmann/json.hpp>

#include "localization/synthetic_drive.h"
#include "map/map_fixtures.h"
#include "pose_argument.h"
#include "real_data.h"
#include "run_app_program.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/io/point_cloud_file.h"

namespace saw_ndt {

using namespace internal;

namespace {

Eigen::Isometry3d transformIn(const nlohmann::json& json) {
  Eigen::Isometry3d T;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) T(row, column) = json.at("T_target_source").at(row).at(column);
  }
  return T;
}

void expectNear(const Eigen::Isometry3d& T, const Eigen::Isometry3d& expected, double metres, double degrees) {
  EXPECT_LT((T.translation() - expected.translation()).norm(), metres) << T.matrix();
  EXPECT_LT(degreesFromRadians(rotationAngle(T.linear().transpose() * expected.linear())), degrees) << T.matrix();
}

class AlignApp : public ::testing::Test {
 protected:
  AlignApp() {
    const pcl::PointCloud<pcl::PointXYZL> target = mixedCloud(1, 12000);
    pcl::PointCloud<pcl::PointXYZL> source;
    pcl::transformPointCloud(mixedCloud(2, 6000), source, T_target_source.inverse().matrix());
    writePcd(folder.path() / "target.pcd", target);
    writePcd(folder.path() / "source.pcd", source);
    writePcd(folder.path() / "plain_target.pcd", withoutLabels(target));
    writePcd(folder.path() / "plain_source.pcd", withoutLabels(source));
  }

  AppResult run(const std::string& arguments) const { return runAppProgram(SAW_NDT_APP, arguments); }
  std::string quoted(const std::string& name) const { return "'" + (folder.path() / name).string() + "' "; }

  nlohmann::json jsonOf(const std::string& arguments) const {
    const AppResult result = run(arguments + " -json");
    EXPECT_EQ(result.exit_code, 0) << arguments << '\n' << result.errors;
    return nlohmann::json::parse(result.output, nullptr, false);
  }

  TemporaryFolder folder;
  Eigen::Isometry3d T_target_source = transformOf({0.4, -0.25, 0.1, 0.5, -0.4, 2.0});
};

TEST_F(AlignApp, FindsTheTransformWithAndWithoutLabels) {
  for (const auto& [arguments, weighted] :
       {std::pair<std::string, bool>{quoted("source.pcd") + quoted("target.pcd"), true},
        {quoted("source.pcd") + quoted("target.pcd") + "-classical", false},
        {quoted("plain_source.pcd") + quoted("target.pcd"), false},
        {quoted("plain_source.pcd") + quoted("plain_target.pcd"), false}}) {
    SCOPED_TRACE(arguments);
    const nlohmann::json json = jsonOf(arguments);
    EXPECT_EQ(json.at("weighted"), weighted);
    EXPECT_EQ(json.at("converged"), true);
    EXPECT_GE(json.at("iterations"), 1);
    EXPECT_GT(json.at("likelihood").get<double>(), 0.0);
    EXPECT_EQ(json.at("source_points"), 6000);
    EXPECT_FALSE(json.contains("fitness_m2"));
    expectNear(transformIn(json), T_target_source, 0.03, 0.3);
  }
}

TEST_F(AlignApp, LabelsOfOthersDoNotMatterWhereTheyAreNotUsed) {
  for (const std::string name : {"source", "target"}) {
    auto cloud = readPointCloud<pcl::PointXYZL>(folder.path() / (name + ".pcd"));
    for (pcl::PointXYZL& point : cloud) point.label = 40;
    writePcd(folder.path() / ("classes_" + name + ".pcd"), cloud);
  }
  const std::string files = quoted("classes_source.pcd") + quoted("classes_target.pcd");
  EXPECT_EQ(run(files).exit_code, 1);
  EXPECT_EQ(jsonOf(files + "-classical"), jsonOf(quoted("source.pcd") + quoted("target.pcd") + "-classical"));
  EXPECT_EQ(jsonOf(quoted("plain_source.pcd") + quoted("classes_target.pcd")).at("weighted"), false);
}

TEST_F(AlignApp, EveryWayToSearchEndsAtTheSamePose) {
  const std::string files = quoted("source.pcd") + quoted("target.pcd");
  for (const std::string neighbors : {"radius", "direct26", "direct7", "direct1"}) {
    SCOPED_TRACE(neighbors);
    expectNear(transformIn(jsonOf(files + "-neighbors " + neighbors + " -guess 0.35,-0.2,0.1,0,0,1.5")),
               T_target_source, 0.05, 0.5);
  }
  const nlohmann::json pcl_like =
      jsonOf(files + "-optimizer newton-more-thuente -guess 0.35,-0.2,0.1,0,0,1.5 -max-iterations 200");
  expectNear(transformIn(pcl_like), T_target_source, 0.05, 0.5);
}

TEST_F(AlignApp, WritesTheMovedSourceAndTellsItsFitness) {
  const std::string files = quoted("source.pcd") + quoted("target.pcd") + quoted("out.pcd");
  const nlohmann::json json = jsonOf(files + "-fitness -source-voxel 0.2 -resolution 0.8");
  EXPECT_LT(json.at("source_points"), 6000);
  EXPECT_LT(json.at("fitness_m2").get<double>(), 0.5);
  const auto moved = readPointCloud<pcl::PointXYZL>(folder.path() / "out.pcd");
  const auto source = readPointCloud<pcl::PointXYZL>(folder.path() / "source.pcd");
  ASSERT_EQ(moved.size(), source.size());
  const Eigen::Isometry3d T = transformIn(json);
  for (std::size_t i = 0; i < moved.size(); ++i) {
    ASSERT_LT((T * source[i].getVector3fMap().cast<double>() - moved[i].getVector3fMap().cast<double>()).norm(), 1e-4);
    ASSERT_EQ(moved[i].label, source[i].label);
  }
}

TEST_F(AlignApp, TextTellsTheSameAsJson) {
  const std::string files = quoted("source.pcd") + quoted("target.pcd");
  const nlohmann::json json = jsonOf(files);
  const AppResult text = run(files);
  ASSERT_EQ(text.exit_code, 0) << text.errors;
  std::istringstream lines(text.output);
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      double value = 0.0;
      ASSERT_TRUE(lines >> value);
      EXPECT_NEAR(value, json.at("T_target_source").at(row).at(column).get<double>(), 1e-9);
    }
  }
  EXPECT_NE(text.output.find("\nyaw_deg         " + json.at("yaw_deg").dump() + "\n"), std::string::npos)
      << text.output;
  expectNear(transformOf({json.at("x_m"), json.at("y_m"), json.at("z_m"), json.at("roll_deg"), json.at("pitch_deg"),
                          json.at("yaw_deg")}),
             transformIn(json), 1e-9, 1e-6);
  EXPECT_EQ(jsonOf(files + "-threads 1"), jsonOf(files + "-threads 2"));
}

TEST_F(AlignApp, SaysWhatIsWrongAndWritesNothing) {
  auto bad_labels = mixedCloud(1, 100);
  bad_labels[7].label = 40;
  writePcd(folder.path() / "classes.pcd", bad_labels);
  folder.write("short.bin", "12345");
  const std::string files = quoted("source.pcd") + quoted("target.pcd");
  const struct {
    std::string arguments;
    int exit_code;
    std::string reason;
  } cases[] = {
      {quoted("source.pcd"), 2, "missing TARGET"},
      {files + "-resolution 0", 2, "resolution = 0: must be positive"},
      {files + "-max-iterations 0", 2, "max-iterations = 0"},
      {files + "-source-voxel -1", 2, "source-voxel = -1"},
      {files + "-guess 1,2,3", 2, "'1,2,3' has 3 numbers"},
      {files + "-neighbors direct8", 2, "direct8"},
      {quoted("none.pcd") + quoted("target.pcd"), 1, "none.pcd: No such file"},
      {quoted("source.pcd") + quoted("short.bin"), 1, "short.bin: offset 0"},
      {quoted("classes.pcd") + quoted("target.pcd"), 1, "classes.pcd: point 7: label 40"},
      {files + quoted("out.pcd") + "-guess 500,0,0,0,0,0", 1, "source.pcd: could not be aligned to"},
      {files + quoted("out.pcd") + "-max-iterations 1 -optimizer newton-more-thuente -guess 0.6,-0.1,0.1,0,0,2", 1,
       "too few points fit the target after 1 iterations"},
      {files + quoted("none/out.pcd"), 1, "none/out.pcd: No such file"},
  };
  for (const auto& c : cases) {
    const AppResult result = run(c.arguments);
    EXPECT_EQ(result.exit_code, c.exit_code) << c.arguments;
    EXPECT_NE(result.errors.find(c.reason), std::string::npos) << result.errors;
    EXPECT_EQ(result.output, "");
  }
  EXPECT_EQ(folder.entryCount(), 6U);
}

TEST_F(AlignApp, WhereNothingHoldsAPoseThereIsNone) {
  SensorModel sensor = SensorModel::named("HDL-64E");
  sensor.columns = 600;
  const auto write = [&](const std::string& name, const std::vector<Block>& blocks, unsigned seed) {
    Eigen::Isometry3d T_ground_lidar = Eigen::Isometry3d::Identity();
    T_ground_lidar.translation() << -5.0, -2.0, 1.73;
    pcl::PointCloud<pcl::PointXYZ> cloud;
    for (const LidarPoint& point : scanBlocks(blocks, sensor, T_ground_lidar, seed)) {
      cloud.push_back({point.x, point.y, point.z});
    }
    writePcd(folder.path() / name, cloud);
  };
  const std::vector<Block> yard = {{{10, -20, 0}, {11, 20, 4}},
                                   {{-18, 12, 0}, {20, 13, 4}},
                                   {{-3, -9, 0}, {1, -6, 2.5}},
                                   {{4, 4, 0}, {6, 7, 2.5}},
                                   {{-14, -4, 0}, {-12, 3, 3}}};
  write("street.pcd", streetBlocks(), 1);
  write("yard.pcd", yard, 2);
  pcl::PointCloud<pcl::PointXYZ> three_points;
  three_points.push_back({5.0F, 0.0F, -1.7F});
  three_points.push_back({0.0F, 6.0F, -1.7F});
  three_points.push_back({-4.0F, -3.0F, -1.7F});
  writePcd(folder.path() / "three_points.pcd", three_points);
  for (const std::string source : {"three_points.pcd", "yard.pcd"}) {
    for (const std::string options : {"", "-source-voxel 0.2", "-optimizer newton-more-thuente -neighbors radius"}) {
      SCOPED_TRACE(source + " " + options);
      const AppResult result = run(quoted(source) + quoted("street.pcd") + quoted("out.pcd") + options);
      EXPECT_EQ(result.exit_code, 1);
      EXPECT_EQ(result.output, "");
      EXPECT_NE(result.errors.find(source + ": could not be aligned to"), std::string::npos) << result.errors;
      EXPECT_NE(result.errors.find("too few points fit the target"), std::string::npos) << result.errors;
      EXPECT_FALSE(std::filesystem::exists(folder.path() / "out.pcd"));
    }
  }
}

TEST_F(AlignApp, CloudsFarFromTheOriginAreAlignedAsNearOnes) {
  const Eigen::Vector3f origin(66000.0F, 43000.0F, 40.0F);
  for (const std::string name : {"source", "target"}) {
    auto cloud = readPointCloud<pcl::PointXYZL>(folder.path() / (name + ".pcd"));
    for (pcl::PointXYZL& point : cloud) point.getVector3fMap() += origin;
    writePcd(folder.path() / ("far_" + name + ".pcd"), cloud);
  }
  for (const std::string options : {"", "-source-voxel 0.2"}) {
    SCOPED_TRACE(options);
    const nlohmann::json near = jsonOf(quoted("source.pcd") + quoted("target.pcd") + options);
    const nlohmann::json far = jsonOf(quoted("far_source.pcd") + quoted("far_target.pcd") + options);
    const Eigen::Translation3d T_map_origin(origin.cast<double>());
    // Coordinates are in steps of 8 mm there, and points have 2 cm of noise.
    const Eigen::Isometry3d T_around_origin(T_map_origin.inverse() * transformIn(far) * T_map_origin);
    expectNear(T_around_origin, transformIn(near), 0.01, 0.05);
    // Rounding costs a step or two until none is longer than a millimetre.
    EXPECT_LE(far.at("evaluations").get<int>(), near.at("evaluations").get<int>() + 4);
  }
}

TEST_F(AlignApp, RealScansOfOtherPlacesAreNotAligned) {
  if (realDataFolder().empty()) GTEST_SKIP() << "no real scans: set SAW_NDT_DATA to their folder";
  const auto scanOf = [](const std::string& name, int scan) {
    return "'" + KittiSequence(realDataFolder() / "kitti" / "sequences" / name).scanPath(scan).string() + "' ";
  };
  // Other drives, and the end of this one, which is 25 m away: too far without a guess.
  for (const std::string& other : {scanOf("00", 0), scanOf("01", 0), scanOf("03", 0), scanOf("drive_0005", 69)}) {
    const AppResult result = run(other + scanOf("drive_0005", 0) + "-source-voxel 0.2");
    EXPECT_EQ(result.exit_code, 1) << other;
    EXPECT_NE(result.errors.find("too few points fit the target"), std::string::npos) << result.errors;
  }
}

TEST_F(AlignApp, RealScans) {
  if (realDataFolder().empty()) GTEST_SKIP() << "no real scans: set SAW_NDT_DATA to their folder";
  const KittiSequence sequence(realDataFolder() / "kitti" / "sequences" / "drive_0005");
  const std::vector<Eigen::Isometry3d> poses = sequence.posesLidar();
  const nlohmann::json json =
      jsonOf("'" + sequence.scanPath(2).string() + "' '" + sequence.scanPath(0).string() + "' -source-voxel 0.2");
  EXPECT_EQ(json.at("weighted"), false);
  expectNear(transformIn(json), poses[0].inverse() * poses[2], 0.05, 0.2);
}

TEST_F(AlignApp, RealScansAreFoundWithoutAGuess) {
  if (realDataFolder().empty()) GTEST_SKIP() << "no real scans: set SAW_NDT_DATA to their folder";
  const KittiSequence sequence(realDataFolder() / "kitti" / "sequences" / "drive_0005");
  const KittiSequence elsewhere(realDataFolder() / "kitti" / "sequences" / "00");
  const std::vector<Eigen::Isometry3d> poses = sequence.posesLidar();
  const std::string target = "'" + sequence.scanPath(0).string() + "' -global";
  // 9.7 m away and turned by 21 degrees: out of reach of an alignment from the identity. The scans see half of each
  // other, and references are those of GNSS.
  expectNear(transformIn(jsonOf("'" + sequence.scanPath(30).string() + "' " + target)), poses[0].inverse() * poses[30],
             0.3, 0.5);
  const AppResult result = run("'" + elsewhere.scanPath(0).string() + "' " + target);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.errors.find("was not found in"), std::string::npos) << result.errors;
  EXPECT_EQ(run("'" + sequence.scanPath(2).string() + "' " + target + " -guess 1,0,0,0,0,0").exit_code, 2);
}

}  // namespace
}  // namespace saw_ndt
