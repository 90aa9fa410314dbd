#include <gtest/gtest.h>

#include "drives/imported_cloud.h"
#include "run_app_program.h"
#include "saw_ndt/drives/map_import.h"

namespace saw_ndt {
namespace {

class MapImportApp : public ::testing::Test {
 protected:
  AppResult run(const std::string& arguments) const { return runAppProgram(SAW_NDT_APP, arguments); }
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }

  TemporaryFolder folder;
  LabelledCloud cloud = mixedCloud(2, 4000);
};

TEST_F(MapImportApp, WritesTheMapOfTheLibraryAndTellsIt) {
  folder.write("a.pcd", pcdText(fieldsOf(cloud), "binary"));
  const AppResult result = run("'" + path("a.pcd") + "' '" + path("a.map") + "' -resolution 1");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("from 4000 points of 1 file, labelled\n"), std::string::npos) << result.output;
  EXPECT_EQ(result.output.find("origin"), std::string::npos) << result.output;
  MapImportOptions options;
  options.resolution_m = 1.0;
  EXPECT_TRUE(contentOf(path("a.map")) == savedBytes(importMap(path("a.pcd"), options).builder.build()));
}

TEST_F(MapImportApp, TellsTheOriginThatItTakesOff) {
  std::vector<TestField> fields = fieldsOf(cloud, false);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    fields[axis].size = 8;
    for (double& value : fields[axis].values) value += axis == 0 ? 456700.0 : 5432100.0;
  }
  folder.write("utm.pcd", pcdText(fields, "binary"));
  const std::string files = "'" + path("utm.pcd") + "' '" + path("a.map") + "'";
  AppResult result = run(files);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("origin taken off: 457000,5432000,0 "), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("labels left aside: "), std::string::npos) << result.output;
  result = run(files + " -origin 456000,5432000,-1.5 -labels heights");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("origin taken off: 456000,5432000,-1.5 "), std::string::npos) << result.output;
  const WeightedVoxelMap map = WeightedVoxelMap::load(path("a.map"));
  EXPECT_TRUE(map.labelled());
  EXPECT_EQ(map.origin().map_origin_m, Eigen::Vector3d(456000.0, 5432000.0, -1.5));
}

TEST_F(MapImportApp, ErrorsLeaveNothingBehind) {
  const std::string text = pcdText(fieldsOf(cloud), "ascii");
  folder.write("cut.pcd", text.substr(0, text.rfind('\n', text.size() - 2) - 20));
  AppResult result = run("'" + path("cut.pcd") + "' '" + path("a.map") + "'");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.errors.find("saw_ndt_map_import: " + path("cut.pcd")), std::string::npos) << result.errors;
  result = run("'" + path("cut.pcd") + "' '" + path("a.map") + "' -origin 1,2");
  EXPECT_EQ(result.exit_code, 2);
  result = run("'" + path("cut.pcd") + "' '" + path("a.map") + "' -resolution 0");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(folder.entryCount(), 1U);
}

}  // namespace
}  // namespace saw_ndt
