#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "io/pcd_text.h"
#include "real_data.h"
#include "report/segmentation_score.h"
#include "run_app_program.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/io/point_cloud_file.h"
#include "saw_ndt/segmentation/scan_segmenter.h"
#include "segmentation/synthetic_scan.h"

namespace saw_ndt {

namespace {

/// Flat ground, and ahead of the sensor a wall across the road, 15 m away and 3 m high.
pcl::PointCloud<pcl::PointXYZ> roadAndWall() {
  const SensorModel sensor = SensorModel::named("HDL-64E");
  return ringOrderedScan(sensor, [&](int row, int column) {
    const double ground_m = rangeToFlatGround(sensor, row, 40.0);
    const double elevation = radiansFromDegrees(sensor.elevations_deg[static_cast<std::size_t>(row)]);
    const double azimuth = (column + 0.5) * 2.0 * kPi / sensor.columns;
    const double wall_m = 15.0 / (std::cos(elevation) * std::cos(azimuth));
    const bool on_wall = std::abs(wrappedAngle(azimuth)) < 0.6 && wall_m * std::sin(elevation) < 3.0 - kSensorHeight;
    return on_wall ? std::min(wall_m, ground_m) : ground_m;
  });
}

class SegmentApp : public ::testing::Test {
 protected:
  AppResult run(const std::string& arguments) const { return runAppProgram(SAW_NDT_APP, arguments); }
  std::string quoted(const std::string& name) const { return "'" + (folder.path() / name).string() + "' "; }

  void writeScan(const std::string& name, const pcl::PointCloud<pcl::PointXYZ>& cloud) const {
    std::string bytes;
    for (const pcl::PointXYZ& point : cloud) {
      const float values[] = {point.x, point.y, point.z, 0.25F};
      bytes.append(reinterpret_cast<const char*>(values), sizeof(values));
    }
    folder.write(name, bytes);
  }

  /// SemanticKITTI: 40 road, 50 building, each with an instance number that does not matter.
  void writeLabels(const std::string& name, const pcl::PointCloud<pcl::PointXYZ>& cloud) const {
    std::string bytes;
    for (const pcl::PointXYZ& point : cloud) {
      const std::uint32_t label = (point.z < -kSensorHeight + 0.01 ? 40U : 50U) | 7U << 16;
      bytes.append(reinterpret_cast<const char*>(&label), sizeof(label));
    }
    folder.write(name, bytes);
  }

  TemporaryFolder folder;
};

TEST_F(SegmentApp, LabelsEveryPointAndScoresTheGround) {
  const pcl::PointCloud<pcl::PointXYZ> scan = roadAndWall();
  writeScan("a.bin", scan);
  writeLabels("a.label", scan);
  const AppResult result = run(quoted("a.bin") + quoted("a.pcd") + "-labels " + quoted("a.label"));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const auto json = nlohmann::json::parse(result.output);
  const auto labelled = readPointCloud<pcl::PointXYZL>(folder.path() / "a.pcd");
  ASSERT_EQ(labelled.size(), scan.size());
  GroundScore expected;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    ASSERT_EQ(labelled[i].getVector3fMap(), scan[i].getVector3fMap());
    const bool ground = scan[i].z < -kSensorHeight + 0.01;
    if (labelled[i].label == 1) ++(ground ? expected.true_positives : expected.false_positives);
    if (labelled[i].label != 1) ++(ground ? expected.false_negatives : expected.true_negatives);
  }
  EXPECT_EQ(json.at("true_positives"), expected.true_positives);
  EXPECT_EQ(json.at("false_positives"), expected.false_positives);
  EXPECT_EQ(json.at("false_negatives"), expected.false_negatives);
  EXPECT_EQ(json.at("true_negatives"), expected.true_negatives);
  EXPECT_DOUBLE_EQ(json.at("precision"), expected.precision());
  EXPECT_DOUBLE_EQ(json.at("recall"), expected.recall());
  EXPECT_DOUBLE_EQ(json.at("iou"), expected.iou());
  EXPECT_GT(json.at("f1").get<double>(), 0.97);
  EXPECT_LT(json.at("noise_share").get<double>(), 0.05);
}

TEST_F(SegmentApp, ReadsPcdAndTellsTheCounts) {
  const pcl::PointCloud<pcl::PointXYZ> scan = roadAndWall();
  writePcd(folder.path() / "in.pcd", scan);
  for (const std::string rule : {"growing", "inclination"}) {
    const AppResult result = run(quoted("in.pcd") + quoted("out.pcd") + "-ground-rule " + rule);
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_NE(result.output.find("out.pcd: " + std::to_string(scan.size()) + " points, "), std::string::npos);
    std::size_t counts[3] = {0, 0, 0};
    for (const pcl::PointXYZL& point : readPointCloud<pcl::PointXYZL>(folder.path() / "out.pcd")) ++counts[point.label];
    EXPECT_NE(result.output.find(", " + std::to_string(counts[1]) + " ground, " + std::to_string(counts[2]) +
                                 " non-ground, " + std::to_string(counts[0]) + " noise\n"),
              std::string::npos)
        << result.output;
    EXPECT_GT(counts[1], scan.size() / 2);
  }
}

TEST_F(SegmentApp, KeepsWhatTheScanTellsOfItsPoints) {
  // Five floats a point, the fifth a ring that begins to count at the bottom, and the same as PCD with other fields.
  const SensorModel sensor = SensorModel::named("HDL-64E");
  const pcl::PointCloud<pcl::PointXYZ> scan = roadAndWall();
  std::vector<double> x, y, z, rings, numbers;
  std::string bytes;
  for (const pcl::PointXYZ& point : scan) {
    const double elevation_deg = degreesFromRadians(std::atan2(point.z, std::hypot(point.x, point.y)));
    std::size_t ring = 0;
    for (std::size_t i = 0; i < sensor.elevations_deg.size(); ++i) {
      const auto off = [&](std::size_t k) { return std::abs(sensor.elevations_deg[k] - elevation_deg); };
      if (off(i) < off(ring)) ring = i;
    }
    rings.push_back(static_cast<double>(sensor.elevations_deg.size() - 1 - ring));
    numbers.push_back(static_cast<double>(numbers.size()));
    x.push_back(point.x);
    y.push_back(point.y);
    z.push_back(point.z);
    const float values[] = {point.x, point.y, point.z, 0.25F, static_cast<float>(rings.back())};
    bytes.append(reinterpret_cast<const char*>(values), sizeof(values));
  }
  folder.write("five.bin", bytes);
  folder.write("in.pcd", pcdText({{"x", 'F', 4, 1, x},
                                  {"_", 'U', 1, 4, x},
                                  {"y", 'F', 4, 1, y},
                                  {"z", 'F', 4, 1, z},
                                  {"label", 'U', 2, 1, rings},
                                  {"ring", 'U', 2, 1, rings},
                                  {"number", 'U', 4, 1, numbers}},
                                 "binary"));
  ASSERT_EQ(run(quoted("five.bin") + quoted("five.pcd")).exit_code, 0);
  ASSERT_EQ(run(quoted("five.bin") + quoted("stated.pcd") + "-bin-fields 5").exit_code, 0);
  ASSERT_EQ(run(quoted("in.pcd") + quoted("out.pcd")).exit_code, 0);
  EXPECT_EQ(pointCloudFields(folder.path() / "five.pcd"),
            (std::vector<std::string>{"x", "y", "z", "intensity", "ring", "label"}));
  EXPECT_EQ(pointCloudFields(folder.path() / "out.pcd"),
            (std::vector<std::string>{"x", "y", "z", "ring", "number", "label"}));

  const ScanPoints kept = readScanPoints(folder.path() / "out.pcd");
  ASSERT_EQ(kept.points.size(), scan.size());
  EXPECT_EQ(kept.rings, std::vector<std::uint16_t>(rings.begin(), rings.end()));
  // Rings are used: labels are those of the segmentation that knows them.
  ScanPoints known;
  for (const pcl::PointXYZ& point : scan) known.points.push_back({point.x, point.y, point.z, 0.25F});
  known.rings.assign(rings.begin(), rings.end());
  std::vector<StructuralLabel> expected;
  ScanSegmenter(SegmentationOptions()).segment(viewOf(known), expected);
  for (const std::string name : {"five.pcd", "stated.pcd", "out.pcd"}) {
    const auto labelled = readPointCloud<pcl::PointXYZL>(folder.path() / name);
    ASSERT_EQ(labelled.size(), scan.size()) << name;
    for (std::size_t i = 0; i < scan.size(); ++i) {
      ASSERT_EQ(labelled[i].getVector3fMap(), scan[i].getVector3fMap());
      ASSERT_EQ(labelled[i].label, static_cast<std::uint32_t>(expected[i])) << name << ' ' << i;
    }
  }
  EXPECT_EQ(run(quoted("five.bin") + quoted("x.pcd") + "-bin-fields 7").exit_code, 2);
}

TEST_F(SegmentApp, SaysWhatIsWrongAndWritesNothing) {
  writeScan("a.bin", roadAndWall());
  folder.write("short.bin", "12345");
  folder.write("two.label", std::string(8, '\0'));
  const std::string good = quoted("a.bin") + quoted("out.pcd");
  const struct {
    std::string arguments;
    int exit_code;
    std::string reason;
  } cases[] = {
      {quoted("a.bin"), 2, "missing OUT.pcd"},
      {good + "-sensor LMS", 2, "option -sensor: 'LMS' is none of auto, FILE.json, "},
      {good + "-mounting-pitch-deg 120", 2, "mounting_pitch_deg = 120"},
      {quoted("none.bin") + quoted("out.pcd"), 1, "none.bin: No such file"},
      {quoted("short.bin") + quoted("out.pcd"), 1, "short.bin: offset 0"},
      {quoted("a.ply") + quoted("out.pcd"), 1, "a.ply"},
      {good + "-labels " + quoted("none.label"), 1, "none.label: No such file"},
      {good + "-labels " + quoted("two.label"), 1, "two.label: 2 labels, where"},
      {quoted("a.bin") + quoted("none/out.pcd"), 1, "none/out.pcd: No such file"},
  };
  for (const auto& c : cases) {
    const AppResult result = run(c.arguments);
    EXPECT_EQ(result.exit_code, c.exit_code) << c.arguments;
    EXPECT_NE(result.errors.find(c.reason), std::string::npos) << result.errors;
    EXPECT_EQ(result.output, "");
  }
  EXPECT_EQ(folder.entryCount(), 3U);
}

/// The same scan by a LiDAR upside down.
pcl::PointCloud<pcl::PointXYZ> flipped(pcl::PointCloud<pcl::PointXYZ> scan) {
  for (pcl::PointXYZ& point : scan) {
    point.y = -point.y;
    point.z = -point.z;
  }
  return scan;
}

TEST_F(SegmentApp, SaysWhatItLearnedAndWhatIsStated) {
  writeScan("a.bin", roadAndWall());
  const std::string good = quoted("a.bin") + quoted("out.pcd");
  const std::pair<std::string, std::string> cases[] = {
      {"", "saw_ndt_segment: sensor: HDL-64E, told by elevations; mounting: level, 1.73 m above the ground\n"},
      {"-sensor auto -mounting auto",
       "saw_ndt_segment: sensor: HDL-64E, told by elevations; mounting: level, 1.73 m above the ground\n"},
      {"-mounting stated", "saw_ndt_segment: sensor: HDL-64E, told by elevations; mounting: level\n"},
      {"-mounting stated -sensor-height 1.8",
       "saw_ndt_segment: sensor: HDL-64E, told by elevations; mounting: level, 1.80 m above the ground\n"},
      // Nothing was learned that matters.
      {"-sensor HDL-64E", ""},
      {"-sensor no-rings -mounting-pitch-deg 2", ""},
  };
  for (const auto& [arguments, said] : cases) {
    const AppResult result = run(good + arguments);
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.errors, said) << arguments;
  }
}

TEST_F(SegmentApp, TakesASensorFromAFile) {
  const SensorModel mine = SensorModel::evenlySpaced("mine", 21, 900, 4.0, -26.0);
  writeScan("a.bin", ringOrderedScan(mine, [&](int row, int) { return rangeToFlatGround(mine, row, 40.0); }));
  nlohmann::json json = {{"name", mine.name}, {"columns", mine.columns}, {"elevations_deg", mine.elevations_deg}};
  folder.write("mine.json", json.dump());
  const AppResult result = run(quoted("a.bin") + quoted("out.pcd") + "-sensor " + quoted("mine.json"));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.errors, "");
  json.erase("columns");
  folder.write("lacks.json", json.dump());
  for (const auto& [file, reason] : {std::pair("lacks.json", "columns"), {"none.json", "No such file"}}) {
    const AppResult failed = run(quoted("a.bin") + quoted("no.pcd") + "-sensor " + quoted(file));
    EXPECT_EQ(failed.exit_code, 1);
    EXPECT_NE(failed.errors.find(file), std::string::npos) << failed.errors;
    EXPECT_NE(failed.errors.find(reason), std::string::npos) << failed.errors;
  }
}

TEST_F(SegmentApp, NamesTheSegmentationOptionThatIsWrong) {
  writeScan("a.bin", roadAndWall());
  const std::pair<std::string, std::string> cases[] = {
      {"-sensor LMS", "-sensor"},
      {"-sensor os1", "-sensor"},
      {"-mounting sideways", "-mounting"},
      {"-mounting-roll-deg 200", "mounting_roll_deg = 200"},
      {"-mounting-pitch-deg -91", "mounting_pitch_deg = -91"},
      {"-sensor-height -1", "sensor_height_m = -1"},
      {"-min-range -1", "min_range_m = -1"},
      {"-min-range 5 -max-range 4", "max_range_m = 4"},
      {"-vehicle-box 1,2,3,4,5", "vehicle_box_m.size() = 5"},
      {"-vehicle-box 1,2,3,4,5,x", "-vehicle-box"},
      {"-vehicle-box 1,1,1,2,0,2", "vehicle_box_m"},
      {"-ground-rule best", "-ground-rule"},
      {"-slope-deg 61", "slope_deg = 61"},
  };
  for (const auto& [arguments, named] : cases) {
    const AppResult result = run(quoted("a.bin") + quoted("out.pcd") + arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments;
    EXPECT_NE(result.errors.find(named), std::string::npos) << arguments << ": " << result.errors;
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
  }
  EXPECT_EQ(folder.entryCount(), 1U);
}

TEST_F(SegmentApp, AScanUpsideDownIsSegmentedAsUprightOrWarnedOf) {
  const pcl::PointCloud<pcl::PointXYZ> scan = roadAndWall();
  writeScan("up.bin", scan);
  writeScan("down.bin", flipped(scan));
  writeLabels("a.label", scan);
  const auto f1Of = [&](const std::string& file, const std::string& options) {
    const AppResult result = run(quoted(file) + quoted("out.pcd") + "-labels " + quoted("a.label") + options);
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.errors.find("warning"), std::string::npos) << result.errors;
    return nlohmann::json::parse(result.output).at("f1").get<double>();
  };
  EXPECT_NEAR(f1Of("down.bin", ""), f1Of("up.bin", ""), 0.01);
  const AppResult stated = run(quoted("down.bin") + quoted("out.pcd") + "-mounting stated -sensor HDL-64E");
  EXPECT_EQ(stated.exit_code, 0);
  EXPECT_NE(stated.errors.find("saw_ndt_segment: warning: the ground leans as if the sensor were rolled by "),
            std::string::npos)
      << stated.errors;
  EXPECT_NE(stated.errors.find("; see -mounting auto"), std::string::npos) << stated.errors;
  EXPECT_NE(stated.errors.find("; see -sensor\n"), std::string::npos) << stated.errors;
}

TEST_F(SegmentApp, OfARealScan) {
  if (realDataFolder().empty()) GTEST_SKIP() << "no real scans: set SAW_NDT_DATA to their folder";
  const KittiSequence sequence(realDataFolder() / "kitti" / "sequences" / "00");
  const AppResult result = run("'" + sequence.scanPath(3).string() + "' " + quoted("out.pcd") + "-labels '" +
                               sequence.labelPath(3).string() + "'");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const auto json = nlohmann::json::parse(result.output);
  EXPECT_GT(json.at("f1").get<double>(), 0.9);
  const auto labelled = readPointCloud<pcl::PointXYZL>(folder.path() / "out.pcd");
  const std::vector<std::uint16_t> classes = sequence.readLabels(3);
  ASSERT_EQ(labelled.size(), classes.size());
  std::vector<StructuralLabel> labels;
  for (const pcl::PointXYZL& point : labelled) labels.push_back(structuralLabelFromValue(point.label));
  EXPECT_EQ(json, nlohmann::json::parse(toJsonText(scoreGround(labels, classes))));
}

}  // namespace
}  // namespace saw_ndt
