#include <pcl/common/io.h>
#include <pcl/io/pcd_io.h>

#include <nlohmann/json.hpp>

#include "drive_files.h"
#include "real_data.h"
#include "report/gnuplot.h"
#include "report/map_diff_report.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/io/point_cloud_file.h"
#include "saw_ndt/map/weighted_map_builder.h"

namespace saw_ndt {
namespace {

// Maps of a floor of 10 m by 10 m, in three scans; in the later one stands a box of 2 m x 2 m x 2 m.
class MapDiffApp : public DriveFiles {
 protected:
  MapDiffApp() {
    mapOfFloor(0.0, 0.5).save(folder.path() / "floor.map");
    mapOfFloor(2.0, 0.5).save(folder.path() / "box.map");
  }

  static WeightedVoxelMap mapOfFloor(double box_height_m, double resolution_m, double x_m = 0.0) {
    WeightedMapBuilder builder(resolution_m);
    for (int scan = 0; scan < 3; ++scan) {
      pcl::PointCloud<pcl::PointXYZL> cloud;
      const auto add = [&](double x, double y, double z, std::uint32_t label) {
        pcl::PointXYZL point;
        point.getVector3fMap() =
            Eigen::Vector3d(x_m + x, y,
                            z + 0.002 * static_cast<double>((cloud.size() + static_cast<std::size_t>(scan)) % 5))
                .cast<float>();
        point.label = label;
        cloud.push_back(point);
      };
      for (double x = 0.05; x < 10.0; x += 0.1) {
        for (double y = 0.05; y < 10.0; y += 0.1) {
          const bool in_box = std::abs(x - 5.0) < 1.0 && std::abs(y - 5.0) < 1.0;
          add(x, y, in_box ? 0.2 + box_height_m : 0.2, in_box && box_height_m > 0.0 ? 2 : 1);
        }
      }
      for (double z = 0.3; z < 0.2 + box_height_m; z += 0.1) {
        for (double s = 4.05; s < 6.0; s += 0.1) {
          for (const double side : {4.0, 5.99}) {
            add(s, side, z, 2);
            add(side, s, z, 2);
          }
        }
      }
      // Something high, so that the height of the box has been seen.
      for (double z = 0.3; z < 4.0; z += 0.1) {
        for (double y = 0.05; y < 10.0; y += 0.1) add(9.97, y, z, 2);
      }
      addCloud(builder, cloud, Eigen::Isometry3d::Identity());
    }
    return builder.build();
  }

  std::string path(const std::string& name) const { return quoted(folder.path() / name); }
};

TEST_F(MapDiffApp, TellsWhatHasAppeared) {
  const AppResult json_run = runAppProgram(SAW_NDT_APP, path("floor.map") + path("box.map") + "-json");
  ASSERT_EQ(json_run.exit_code, 0) << json_run.errors;
  EXPECT_EQ(json_run.errors, "");
  const auto json = nlohmann::json::parse(json_run.output);
  const MapDiff diff = diffMaps(mapOfFloor(0.0, 0.5), mapOfFloor(2.0, 0.5));
  EXPECT_EQ(json.at("resolution_m"), 0.5);
  EXPECT_EQ(json.at("least_points"), 10);
  EXPECT_EQ(json.at("first").at("vanished"), 0);
  EXPECT_EQ(json.at("second").at("appeared"), diff.second.changed);
  EXPECT_EQ(json.at("second").at("compared"), diff.second.compared);
  EXPECT_GT(diff.second.changed, 30U);
  ASSERT_EQ(json.at("groups").size(), 1U);
  EXPECT_EQ(json.at("groups")[0].at("change"), "appeared");
  EXPECT_EQ(json.at("groups")[0].at("voxels"), diff.second.changed);
  EXPECT_EQ(json.at("groups")[0].at("greatest_m"), nlohmann::json({6.0, 6.0, 2.5}));

  const AppResult text_run = runAppProgram(SAW_NDT_APP, path("box.map") + path("floor.map"));
  ASSERT_EQ(text_run.exit_code, 0) << text_run.errors;
  EXPECT_NE(text_run.output.find("first.vanished                " + std::to_string(diff.second.changed) + "\n"),
            std::string::npos)
      << text_run.output;
  EXPECT_NE(text_run.output.find("vanished  "), std::string::npos) << text_run.output;
}

TEST_F(MapDiffApp, WritesTheChangedVoxels) {
  const AppResult result = runAppProgram(SAW_NDT_APP, path("floor.map") + path("box.map") + "-pcd " + path("out.pcd"));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const MapDiff diff = diffMaps(mapOfFloor(0.0, 0.5), mapOfFloor(2.0, 0.5));
  pcl::PCLPointCloud2 fields;
  ASSERT_EQ(pcl::PCDReader().read((folder.path() / "out.pcd").string(), fields), 0);
  pcl::PointCloud<ChangedPoint> read;
  pcl::fromPCLPointCloud2(fields, read);
  ASSERT_EQ(read.size(), diff.changes.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].change, 1.0F);
    EXPECT_EQ(read[i].map, 2.0F);
    EXPECT_EQ(read[i].displacement, 0.0F);
    EXPECT_EQ(read[i].label, 2U);
    EXPECT_LT((read[i].getVector3fMap().cast<double>() - diff.changes[i].mean_m).norm(), 1e-5);
  }

  const AppResult same = runAppProgram(SAW_NDT_APP, path("box.map") + path("box.map") + "-pcd " + path("same.pcd"));
  EXPECT_EQ(same.exit_code, 0);
  EXPECT_NE(same.errors.find("same.pcd is not written: nothing has changed"), std::string::npos) << same.errors;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "same.pcd"));
}

TEST_F(MapDiffApp, DrawsThem) {
  if (!gnuplotFound()) GTEST_SKIP() << "gnuplot is not installed";
  const AppResult result =
      runAppProgram(SAW_NDT_APP, path("floor.map") + path("box.map") + "-picture " + path("the changes.png"));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(contentOf(folder.path() / "the changes.png").substr(1, 3), "PNG");
  // Nothing else is left: drive, two maps, picture.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 4);
}

TEST_F(MapDiffApp, SaysWhatIsWrongAndLeavesNothingBehind) {
  mapOfFloor(0.0, 1.0).save(folder.path() / "coarse.map");
  mapOfFloor(0.0, 0.5, 1000.0).save(folder.path() / "far.map");
  const std::string both = path("floor.map") + path("box.map");
  expectFails(SAW_NDT_APP, path("floor.map"), 2, {"missing B"});
  expectFails(SAW_NDT_APP, path("floor.map") + path("none.map"), 1, {"none.map: No such file"});
  expectFails(SAW_NDT_APP, path("floor.map") + path("coarse.map"), 1,
              {"coarse.map: cannot be compared with ", "floor.map: resolution_m = 1: must be"});
  expectFails(SAW_NDT_APP, both + "-least-points 2", 2, {"least_points = 2"});
  expectFails(SAW_NDT_APP, both + "-least-displacement 0", 2, {"least_displacement_m = 0"});
  expectFails(SAW_NDT_APP, both + "-picture " + path("out.svg"), 2, {"out.svg", "must end in .png"});
  expectFails(SAW_NDT_APP, both + "-picture " + path("no/out.png"), 1, {"no/out.png: No such file"});
  expectFails(SAW_NDT_APP, both + "-pcd " + path("no/out.pcd"), 1, {"no/out.pcd: No such file"});

  const AppResult far = runAppProgram(SAW_NDT_APP, path("floor.map") + path("far.map") + "-json");
  EXPECT_EQ(far.exit_code, 0);
  EXPECT_NE(far.errors.find("no place in common"), std::string::npos) << far.errors;
  EXPECT_EQ(nlohmann::json::parse(far.output).at("groups").size(), 0U);
}

TEST_F(MapDiffApp, HalvesOfARealDriveDifferByNextToNothing) {
  if (realDataFolder().empty()) GTEST_SKIP() << "no real scans: set SAW_NDT_DATA to their folder";
  const KittiSequence sequence(realDataFolder() / "kitti" / "sequences" / "drive_0005");
  std::vector<int> even, odd;
  for (int i = 0; i < 60; ++i) (i % 2 == 0 ? even : odd).push_back(i);
  const MapDiff diff =
      diffMaps(buildDriveMap(*sequence.scans(even), {}).build(), buildDriveMap(*sequence.scans(odd), {}).build());
  for (const MapDiffSide& side : {diff.first, diff.second}) {
    EXPECT_GT(side.compared, 10000U);
    EXPECT_LT(static_cast<double>(side.changed + side.moved), 0.0005 * static_cast<double>(side.compared));
    EXPECT_LT(static_cast<double>(side.not_covered), 0.002 * static_cast<double>(side.compared));
  }
}

}  // namespace
}  // namespace saw_ndt
