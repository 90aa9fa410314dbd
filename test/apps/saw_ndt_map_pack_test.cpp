#include <nlohmann/json.hpp>

#include "drive_files.h"
#include "saw_ndt/map/localization_map.h"

namespace saw_ndt {
namespace {

class MapPackApp : public DriveFiles {
 protected:
  std::string path(const std::string& name) const { return quoted(folder.path() / name); }

  /// Runs an app that is to succeed.
  AppResult run(const std::string& program, const std::string& arguments) const {
    const AppResult result = runAppProgram(program, arguments);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return result;
  }
  void buildMap(const std::string& options = "") const {
    run(SAW_NDT_BUILD_MAP_APP, quoted(drive_folder) + path("statistics.map") + kSensor + options);
  }
};

TEST_F(MapPackApp, GivesAMapToLocalizeInByItsTiles) {
  buildMap();
  const AppResult packed = run(SAW_NDT_APP, path("statistics.map") + path("packed.map"));
  const LocalizationMap map((folder.path() / "packed.map").string());
  EXPECT_NE(packed.output.find(std::to_string(map.voxelCount()) + " voxels and "), std::string::npos) << packed.output;
  EXPECT_NE(packed.output.find(std::to_string(map.fileSize()) + " bytes"), std::string::npos) << packed.output;
  const std::string drive = quoted(drive_folder), options = std::string(kSensor) + "-skip 0";
  const auto exact =
      nlohmann::json::parse(run(SAW_NDT_LOCALIZE_APP, drive + path("statistics.map") + path("exact") + options).output);
  const auto tiled =
      nlohmann::json::parse(run(SAW_NDT_LOCALIZE_APP, drive + path("packed.map") + path("tiled") + options).output);
  EXPECT_EQ(exact.count("tiles"), 0U);
  EXPECT_GE(tiled["tiles"]["loads"], 1);
  EXPECT_EQ(tiled["accepted"], exact["accepted"]);
  const double ate_m = exact["ate_rmse_m"];
  EXPECT_NEAR(tiled["ate_rmse_m"], ate_m, 0.01 * ate_m);
}

TEST_F(MapPackApp, ServesTheMethodsWhoseVoxelsAreAlike) {
  buildMap();
  run(SAW_NDT_APP, path("statistics.map") + path("paper.map") + "-method weighted-s50");
  run(SAW_NDT_LOCALIZE_APP,
      quoted(drive_folder) + path("paper.map") + path("out") + kSensor + "-skip 0 -method weighted-s100");
  expectFails(SAW_NDT_LOCALIZE_APP, quoted(drive_folder) + path("paper.map") + path("other") + kSensor, 1,
              {"paper.map", "was packed for other voxels"});
  expectFails(SAW_NDT_LOCALIZE_APP, quoted(drive_folder) + path("paper.map") + path("other") + kSensor + "-map-radius 0", 2,
              {"radius_m"});
}

TEST_F(MapPackApp, RefusesWhatIsNoStatisticsMap) {
  buildMap();
  run(SAW_NDT_APP, path("statistics.map") + path("packed.map"));
  expectFails(SAW_NDT_APP, path("packed.map") + path("again.map"), 1, {"packed.map", "localization map"});
  expectFails(SAW_NDT_APP, path("none.map") + path("out.map"), 1, {"none.map", "No such file"});
  expectFails(SAW_NDT_APP, path("statistics.map") + path("no/folder/out.map"), 1, {"no/folder"});
}

}  // namespace
}  // namespace saw_ndt
