#include <gtest/gtest.h>
#include <pcl/common/io.h>
#include <pcl/io/pcd_io.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "map/map_fixtures.h"
#include "real_data.h"
#include "report/gnuplot.h"
#include "report/voxel_cloud.h"
#include "run_app_program.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/io/point_cloud_file.h"
#include "saw_ndt/map/ndt_target.h"

namespace saw_ndt {

using namespace internal;

namespace {

class MapInfoApp : public ::testing::Test {
 protected:
  AppResult run(const std::string& arguments) const { return runAppProgram(SAW_NDT_APP, arguments); }
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }

  /// The PCD holds one point a voxel, as voxelCloud() makes it.
  void expectVoxels(const std::string& pcd, const WeightedVoxelMap& map) const {
    EXPECT_EQ(pointCloudFields(pcd), (std::vector<std::string>{"x", "y", "z", "label", "structure_class", "weight"}));
    pcl::PCLPointCloud2 fields;
    ASSERT_EQ(pcl::PCDReader().read(pcd, fields), 0);
    pcl::PointCloud<VoxelPoint> read;
    pcl::fromPCLPointCloud2(fields, read);
    const pcl::PointCloud<VoxelPoint> expected = voxelCloud(map);
    ASSERT_EQ(read.size(), expected.size());
    for (std::size_t i = 0; i < read.size(); ++i) {
      ASSERT_EQ(read[i].getVector3fMap(), expected[i].getVector3fMap());
      ASSERT_EQ(read[i].label, expected[i].label);
      ASSERT_EQ(read[i].structure_class, expected[i].structure_class);
      ASSERT_EQ(read[i].weight, expected[i].weight);
    }
  }

  TemporaryFolder folder;
};

TEST_F(MapInfoApp, TellsWhatAMapHolds) {
  const WeightedVoxelMap map = mapOf(mixedCloud(1, 5000));
  map.save(path("a.map"));
  const AppResult json_run = run("'" + path("a.map") + "' -json -pcd '" + path("a.pcd") + "'");
  ASSERT_EQ(json_run.exit_code, 0) << json_run.errors;
  const auto json = nlohmann::json::parse(json_run.output);
  EXPECT_EQ(json.at("points"), 5000);
  EXPECT_EQ(json.at("scans"), 1);
  EXPECT_EQ(json.at("labelled"), true);
  EXPECT_EQ(json.at("voxels"), map.voxelCount());
  EXPECT_EQ(json.at("coarse_voxels"), NdtTarget(map).coarseVoxelCount());
  EXPECT_EQ(json.at("entries"), map.entries().size());
  const auto file_bytes = std::filesystem::file_size(path("a.map"));
  EXPECT_EQ(json.at("bytes").at("file"), file_bytes);
  EXPECT_DOUBLE_EQ(json.at("bytes").at("per_voxel").get<double>(),
                   static_cast<double>(file_bytes) / static_cast<double>(map.voxelCount()));
  EXPECT_EQ(json_run.output.find(folder.path().string()), std::string::npos);
  expectVoxels(path("a.pcd"), map);
  EXPECT_EQ(readPointCloud<pcl::PointXYZL>(path("a.pcd")).size(), map.voxelCount());

  const AppResult text_run = run("'" + path("a.map") + "'");
  ASSERT_EQ(text_run.exit_code, 0) << text_run.errors;
  EXPECT_NE(text_run.output.find("points                        5000\n"), std::string::npos) << text_run.output;
}

TEST_F(MapInfoApp, DrawsTheMap) {
  if (!gnuplotFound()) GTEST_SKIP() << "gnuplot is not installed";
  mapOf(mixedCloud(1, 20000)).save(path("a.map"));
  mapOf(withoutLabels(mixedCloud(1, 20000))).save(path("plain.map"));
  std::map<std::string, std::string> pictures;
  for (const std::string colour : {"auto", "label", "class", "weight", "height"}) {
    const AppResult result = run("'" + path("a.map") + "' -picture '" + path(colour + ".png") + "' -colour " + colour);
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    pictures[colour] = contentOf(path(colour + ".png"));
    EXPECT_EQ(pictures[colour].substr(1, 3), "PNG");
  }
  EXPECT_EQ(pictures.at("auto"), pictures.at("label"));
  for (const std::string colour : {"class", "weight", "height"}) EXPECT_NE(pictures.at(colour), pictures.at("label"));
  ASSERT_EQ(run("'" + path("plain.map") + "' -picture '" + path("plain.png") + "'").exit_code, 0);
  const AppResult no_labels = run("'" + path("plain.map") + "' -picture '" + path("no.png") + "' -colour label");
  EXPECT_EQ(no_labels.exit_code, 1);
  EXPECT_NE(no_labels.errors.find("plain.map: has no labels"), std::string::npos) << no_labels.errors;
  // Two maps and six pictures.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 8);
}

TEST_F(MapInfoApp, SaysWhatIsWrong) {
  mapOf(mixedCloud(1, 3000)).save(path("a.map"));
  std::string bytes = contentOf(path("a.map"));
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  folder.write("bad.map", bytes);
  WeightedMapBuilder(1.0).build().save(path("empty.map"));
  const struct {
    std::string arguments;
    int exit_code;
    std::string reason;
  } cases[] = {
      {"", 2, "missing MAP"},
      {"'" + path("a.map") + "' -xml", 2, "-xml"},
      {"'" + path("none.map") + "'", 1, "none.map: No such file"},
      {"'" + path("bad.map") + "'", 1, "bad.map: offset"},
      {"'" + path("bad.map") + "' -pcd '" + path("out.pcd") + "'", 1, "bad.map: offset"},
      {"'" + path("a.map") + "' -pcd '" + path("none/out.pcd") + "'", 1, "none/out.pcd: No such file"},
      {"'" + path("a.map") + "' -picture '" + path("out.jpg") + "'", 2, "must end in .png"},
      {"'" + path("a.map") + "' -picture '" + path("none/out.png") + "'", 1, "none/out.png: No such file"},
      {"'" + path("a.map") + "' -colour label", 2, "-colour goes with -picture"},
      {"'" + path("empty.map") + "' -pcd '" + path("out.pcd") + "'", 1, "out.pcd: a cloud without points"},
  };
  for (const auto& c : cases) {
    const AppResult result = run(c.arguments);
    EXPECT_EQ(result.exit_code, c.exit_code) << c.arguments;
    EXPECT_NE(result.errors.find(c.reason), std::string::npos) << result.errors;
    EXPECT_EQ(result.output, "");
  }
  EXPECT_FALSE(std::filesystem::exists(path("out.pcd")));
  EXPECT_EQ(run("'" + path("empty.map") + "'").exit_code, 0);
}

TEST_F(MapInfoApp, OfARealMap) {
  if (realDataFolder().empty()) GTEST_SKIP() << "no real scans: set SAW_NDT_DATA to their folder";
  const KittiSequence sequence(realDataFolder() / "kitti" / "sequences" / "01");
  const WeightedVoxelMap map = buildDriveMap(*sequence.scans({0, 4}), {}).build();
  map.save(path("a.map"));
  const AppResult result = run("'" + path("a.map") + "' -json -pcd '" + path("a.pcd") + "'");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const auto json = nlohmann::json::parse(result.output);
  EXPECT_EQ(json.at("scans"), 2);
  EXPECT_GT(json.at("label_points").at("ground_share").get<double>(), 0.3);
  EXPECT_GT(json.at("class_voxels").at("planar_share").get<double>(), 0.2);
  EXPECT_LE(json.at("weight").at("max").get<double>(), 1.25);
  expectVoxels(path("a.pcd"), map);
}

}  // namespace
}  // namespace saw_ndt
