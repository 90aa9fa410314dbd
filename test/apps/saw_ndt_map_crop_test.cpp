#include "drive_files.h"
#include "saw_ndt/map/weighted_map_builder.h"

namespace saw_ndt {
namespace {

// A map of voxels of 0.5 m with a point in the middle of each: centres from 0.25 to 9.75 m along x and y, 0.25 and
// 0.75 m along z.
class MapCropApp : public DriveFiles {
 protected:
  MapCropApp() {
    pcl::PointCloud<pcl::PointXYZL> cloud;
    for (int i = 0; i < 20 * 20 * 2; ++i) {
      pcl::PointXYZL point;
      point.getVector3fMap() << static_cast<float>(i % 20), static_cast<float>(i / 20 % 20),
          static_cast<float>(i / 400);
      point.getVector3fMap() = 0.5F * (point.getVector3fMap().array() + 0.5F).matrix();
      point.label = i % 2 == 0 ? 1U : 2U;
      cloud.push_back(point);
    }
    WeightedMapBuilder builder(0.5);
    addCloud(builder, cloud, Eigen::Isometry3d::Identity());
    builder.build().save(folder.path() / "whole.map");
  }

  std::string path(const std::string& name) const { return quoted(folder.path() / name); }

  /// How many voxels are left; 0 where the app failed.
  std::size_t cropped(const std::string& arguments, const std::string& name = "part.map") const {
    SCOPED_TRACE(arguments);
    const AppResult result = runAppProgram(SAW_NDT_APP, path("whole.map") + path(name) + arguments);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(result.errors, "");
    if (result.exit_code != 0) return 0;
    const WeightedVoxelMap map = WeightedVoxelMap::load(folder.path() / name);
    EXPECT_EQ(map.origin().point_count, map.entries().size());
    EXPECT_NE(result.output.find("with " + std::to_string(map.entries().size()) + " of 800 points"), std::string::npos)
        << result.output;
    return map.entries().size();
  }
  void expectCropFails(int exit_code, const std::string& arguments, std::initializer_list<std::string> parts) const {
    expectFails(SAW_NDT_APP, path("whole.map") + path("out.map") + arguments, exit_code, parts);
  }
};

TEST_F(MapCropApp, ToABoxAndAHeight) {
  EXPECT_EQ(cropped("-box 0,0,10,10"), 800U);
  EXPECT_EQ(cropped("-box 1,2,3,4.5"), 4U * 5U * 2U);
  EXPECT_EQ(cropped("-box 1,2,3,4.5 -z-range 0.5,1"), 4U * 5U);
  EXPECT_EQ(cropped("-box -100,0.25,0.75,0.75"), 1U * 1U * 2U);
}

TEST_F(MapCropApp, ToAPolygonOfTextOrCsv) {
  folder.write("l.txt", "# an L\n0 0\n2 0\n2 1\n1 1\n\n1 2\n0 2\n0 0\n");
  EXPECT_EQ(cropped("-polygon " + path("l.txt")), 12U * 2U);
  folder.write("l.csv", "id,Y_m,X_m\n1,0,0\n2,1,0\n3,1,3\n4,0,3\n");
  EXPECT_EQ(cropped("-polygon " + path("l.csv") + "-z-range -1,0.5"), 6U * 2U);
}

TEST_F(MapCropApp, ToWhatLiesAroundATrajectory) {
  const std::string tum = "0 -5 5 100 0 0 0 1\n1 15 5 0 0 0 0 1\n";
  folder.write("line.txt", tum);
  EXPECT_EQ(cropped("-around " + path("line.txt") + "-radius 0.25"), 20U * 2U * 2U);
  EXPECT_EQ(cropped("-around " + path("line.txt")), 800U);
  folder.write("line.csv", "0,-5,5,0,0,0,0,1\n1,15,5,0,0,0,0,1\n");
  EXPECT_EQ(cropped("-around " + path("line.csv") + "-radius 0.75"), 20U * 4U * 2U);
  folder.write("kitti.txt", "1 0 0 0.25 0 1 0 0.25 0 0 1 0\n");
  EXPECT_EQ(cropped("-around " + path("kitti.txt") + "-radius 0.5"), 3U * 2U);
  // The camera looks along x of the LiDAR, which is at (0.75, 0.25).
  folder.write("calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
  folder.write("camera.txt", "1 0 0 -0.25 0 1 0 9 0 0 1 0.75\n");
  EXPECT_EQ(cropped("-around " + path("camera.txt") + "-radius 0.6 -calib " + path("calib.txt")), 4U * 2U);
}

TEST_F(MapCropApp, HalvesMergeIntoTheWhole) {
  ASSERT_EQ(cropped("-box 0,0,4.75,10", "left.map"), 9U * 20U * 2U);
  ASSERT_EQ(cropped("-box 4.75,0,10,10", "right.map"), 11U * 20U * 2U);
  ASSERT_EQ(runAppProgram(SAW_NDT_MAP_MERGE_APP, path("both.map") + path("right.map") + path("left.map")).exit_code, 0);
  // But for the number of scans, at byte 32, and the checksum of the header, all is as it was.
  std::string whole = contentOf(folder.path() / "whole.map"), both = contentOf(folder.path() / "both.map");
  for (std::string* const bytes : {&whole, &both}) bytes->replace(32, 8, 8, ' ').replace(92, 4, 4, ' ');
  EXPECT_TRUE(both == whole);
}

TEST_F(MapCropApp, SaysWhatIsWrongAndLeavesNothingBehind) {
  folder.write("two.txt", "0 0\n1 1\n");
  folder.write("bad.txt", "0 0\n1 one\n1 1\n");
  folder.write("three.txt", "0 0 0\n1 0 0\n1 1 0\n");
  folder.write("names.csv", "lat,lon\n1,2\n3,4\n5,6\n");
  expectCropFails(1, "-box 20,20,30,30", {"whole.map", "nothing is left"});
  expectCropFails(2, "", {"one of -box, -polygon and -around"});
  expectCropFails(2, "-box 0,0,1,1 -around " + path("two.txt"), {"one of -box, -polygon and -around"});
  expectCropFails(2, "-box 0,0,1", {"-box", "4 numbers"});
  expectCropFails(2, "-box 0,3,1,1", {"least_m.y = 3"});
  expectCropFails(2, "-box 0,0,1,1 -z-range 2", {"-z-range"});
  expectCropFails(2, "-box 0,0,1,1 -z-range 2,1", {"least_m.z = 2"});
  expectCropFails(2, "-box 0,0,1,1 -radius 2", {"-radius goes with -around"});
  expectCropFails(1, "-polygon " + path("none.txt"), {"none.txt: No such file"});
  expectCropFails(1, "-polygon " + path("two.txt"), {"two.txt: a polygon has 3 vertices"});
  expectCropFails(1, "-polygon " + path("bad.txt"), {"bad.txt: line 2: 'one'"});
  expectCropFails(1, "-polygon " + path("three.txt"), {"three.txt: line 1: 3 numbers"});
  expectCropFails(1, "-polygon " + path("names.csv"), {"names.csv: names no column x"});
  expectCropFails(1, "-around " + path("two.txt"), {"two.txt: line 1"});
  folder.write("tum.txt", "0 0 0 0 0 0 0 1\n");
  expectCropFails(2, "-around " + path("tum.txt") + "-calib " + path("calib.txt"), {"-calib", "tum.txt is not"});
  expectCropFails(2, "-box 0,0,1,1 -calib calib.txt", {"-calib goes with -around"});
  expectCropFails(2, "-radius -1 -around " + path("tum.txt"), {"radius_m = -1"});
  expectFails(SAW_NDT_APP, path("none.map") + path("out.map") + "-box 0,0,1,1", 1, {"none.map: No such file"});
  expectFails(SAW_NDT_APP, path("whole.map") + path("no/out.map") + "-box 0,0,1,1", 1, {"out.map: No such file"});
}

}  // namespace
}  // namespace saw_ndt
