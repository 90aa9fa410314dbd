#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/run_app_program.h"
#include "map/map_fixtures.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/drives/recording.h"
#include "saw_ndt/io/trajectory.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

namespace fs = std::filesystem;

/// One drive in one form.
struct Form {
  std::string name;
  std::string path;       ///< below the folder of recordings
  std::string arguments;  ///< that say which of its topics are meant
  /// How far reference poses may be from those of KITTI odometry (m and rad), where they are given as latitudes or as a
  /// chain of transforms and thus rounded otherwise; 0: everything is the same to the byte.
  double rounding = 0.0;
  bool is_cut = false;  ///< to the first scans of the drive
};

void PrintTo(const Form& form, std::ostream* out) { *out << form.name; }

/// What the programs make of a recording.
struct Outcome {
  std::string map, trajectory_text;  // the bytes of the files
  std::vector<StampedPose> trajectory;
};

const fs::path kRecordings = SAW_NDT_RECORDINGS;
constexpr char kTopicName[] = "/points", kTopic[] = "-topic /points";

std::string quoted(const fs::path& path) { return "'" + path.string() + "' "; }

/// Expects two poses to be no farther apart than so (m and rad).
void expectAlike(const Eigen::Isometry3d& found, const Eigen::Isometry3d& expected, double tolerance) {
  const Eigen::Isometry3d off = expected.inverse() * found;
  EXPECT_LE(off.translation().norm(), tolerance);
  EXPECT_LE(rotationAngle(off.linear()), tolerance);
}

Outcome outcomeIn(const fs::path& map, const fs::path& results) {
  const fs::path trajectory = results / "trajectory_tum.txt";
  return {contentOf(map), contentOf(trajectory), readTumTrajectory(trajectory)};
}

/// Whether a program says that it was built without what reads a recording.
bool cannotRead(const AppResult& result) { return result.errors.find("built without") != std::string::npos; }

/// Builds a map of a recording and localizes its scans in it. Times of points are made use of. Nothing where the
/// recording cannot be read.
std::optional<Outcome> outcomeOf(const Form& form) {
  const TemporaryFolder folder;
  const fs::path map = folder.path() / "drive.map", results = folder.path() / "results";
  const std::string recording = quoted(kRecordings / form.path),
                    options = form.arguments + " " SAW_NDT_RECORDING_OPTIONS;
  const AppResult built = runAppProgram(SAW_NDT_BUILD_MAP_APP, recording + quoted(map) + options);
  if (cannotRead(built)) return std::nullopt;
  EXPECT_EQ(built.exit_code, 0) << built.errors;
  if (built.exit_code != 0) return Outcome();
  const AppResult localized =
      runAppProgram(SAW_NDT_LOCALIZE_APP, recording + quoted(map) + quoted(results) + "-skip 0 " + options);
  EXPECT_EQ(localized.exit_code, 0) << localized.errors;
  return localized.exit_code == 0 ? outcomeIn(map, results) : Outcome();
}

class RecordingForm : public ::testing::TestWithParam<Form> {
 protected:
  void SetUp() override {
    if (!fs::exists(kRecordings / GetParam().path)) {
      GTEST_SKIP() << GetParam().path << " was not written: recordings.write or recordings.write_mcap says why";
    }
  }
};

TEST_P(RecordingForm, GivesTheMapAndTheTrajectoryOfKittiOdometry) {
  const Form& form = GetParam();
  const std::string reference = form.is_cut ? "reference_kitti_first" : "reference_kitti";
  const Outcome expected = outcomeIn(kRecordings / (reference + ".map"), kRecordings / reference);
  const std::optional<Outcome> outcome = outcomeOf(form);
  if (!outcome) GTEST_SKIP() << "this build does not read it";
  const Outcome& found = *outcome;
  if (form.rounding == 0.0) {
    EXPECT_TRUE(found.map == expected.map)
        << "maps of " << found.map.size() << " and " << expected.map.size() << " bytes differ";
    EXPECT_EQ(found.trajectory_text, expected.trajectory_text);
    return;
  }
  // What is rounded otherwise in its last bits takes an alignment to another end of its last step.
  constexpr double kLastStep = 1e-3;
  ASSERT_EQ(found.trajectory.size(), expected.trajectory.size());
  for (std::size_t i = 0; i < found.trajectory.size(); ++i) {
    EXPECT_EQ(found.trajectory[i].stamp_s, expected.trajectory[i].stamp_s) << "scan " << i;
    expectAlike(found.trajectory[i].T_map_body, expected.trajectory[i].T_map_body, kLastStep);
  }
}

TEST_P(RecordingForm, HasTheScansAndReferencePosesOfKittiOdometry) {
  const Form& form = GetParam();
  const auto expected = openRecording(kRecordings / (form.is_cut ? "kitti_first" : "kitti"));
  RecordingOptions options;
  if (!form.arguments.empty()) options.topic = kTopicName;
  std::unique_ptr<Recording> found;
  try {
    found = openRecording(kRecordings / form.path, options);
  } catch (const Error& error) {
    if (std::string(error.what()).find("built without") != std::string::npos) GTEST_SKIP() << error.what();
    throw;
  }
  EXPECT_EQ(found->stamps(), expected->stamps());
  ASSERT_EQ(found->scanCount(), expected->scanCount());
  // Some roundings of a double of 100 m, and of what a matrix and a quaternion make of a rotation.
  constexpr double kRoundings = 1e-13;
  for (int scan = 0; scan < expected->scanCount(); ++scan) {
    SCOPED_TRACE(found->scanName(scan));
    ScanPoints found_points, expected_points;
    found->readScan(scan, found_points);
    expected->readScan(scan, expected_points);
    ASSERT_EQ(found_points.points.size(), expected_points.points.size());
    EXPECT_EQ(std::memcmp(found_points.points.data(), expected_points.points.data(),
                          expected_points.points.size() * sizeof(LidarPoint)),
              0);
    EXPECT_EQ(found_points.rings, expected_points.rings);
    ASSERT_EQ(found_points.times_s.size(), expected_points.times_s.size());
    for (std::size_t i = 0; i < expected_points.times_s.size(); ++i) {
      ASSERT_NEAR(found_points.times_s[i], expected_points.times_s[i], 1e-15);
    }
    expectAlike(found->referencePose(scan).value(), expected->referencePose(scan).value(),
                std::max(form.rounding, kRoundings));
  }
}

constexpr double kLatitudes = 1e-8, kTransforms = 1e-12;

INSTANTIATE_TEST_SUITE_P(
    All, RecordingForm,
    ::testing::Values(Form{"KittiRaw", "kitti_raw/2023_11_14/2023_11_14_drive_0001_sync", "", kLatitudes},
                      Form{"PcdByStamps", "pcd_stamps", ""}, Form{"PcdByNumbers", "pcd_numbers", ""},
                      Form{"Ply", "ply", ""}, Form{"AsciiPly", "ply_ascii", "", 0.0, true},
                      Form{"Ros1", "ros1/none.bag", kTopic}, Form{"Ros1Bz2", "ros1/bz2.bag", kTopic},
                      Form{"Ros1Lz4", "ros1/lz4.bag", kTopic}, Form{"Ros1Tf", "ros1/tf.bag", kTopic, kTransforms},
                      Form{"Ros2Db3", "ros2_db3", kTopic},
                      Form{"Ros2Db3Tf", "ros2_db3_tf/ros2_db3_tf_0.db3", kTopic, kTransforms},
                      Form{"Mcap", "mcap/none.mcap", kTopic}, Form{"McapZstd", "mcap/zstd.mcap", kTopic},
                      Form{"McapLz4", "mcap/lz4.mcap", kTopic},
                      Form{"McapWithoutChunks", "mcap/no_chunks.mcap", kTopic}),
    [](const auto& instance) { return instance.param.name; });

class DamagedBag : public RecordingForm {};

TEST_P(DamagedBag, IsReadToItsEndAndEachDamagedMessageIsTold) {
  const TemporaryFolder folder;
  const fs::path map = folder.path() / "drive.map";
  const AppResult built =
      runAppProgram(SAW_NDT_BUILD_MAP_APP, quoted(kRecordings / GetParam().path) + quoted(map) + kTopic +
                                               " -classical -motion-compensation off -poses " +
                                               quoted(kRecordings / "damaged/poses.txt"));
  if (cannotRead(built)) GTEST_SKIP() << built.errors;
  ASSERT_EQ(built.exit_code, 0) << built.errors;
  // Of 10000 messages, 10 are of another topic and 10 are damaged; each of the others has 12 points.
  EXPECT_NE(built.output.find(" from 119760 points of 9980 scans, 10 left out\n"), std::string::npos) << built.output;
  std::size_t told = 0;
  for (std::size_t at = 0; (at = built.errors.find(": left out\n", at)) != std::string::npos; ++at) ++told;
  EXPECT_EQ(told, 10u) << built.errors;
}

INSTANTIATE_TEST_SUITE_P(All, DamagedBag,
                         ::testing::Values(Form{"DamagedRos1", "damaged/damaged.bag", ""},
                                           Form{"DamagedDb3", "damaged/damaged.db3", ""},
                                           Form{"DamagedMcap", "damaged/damaged.mcap", ""}),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace saw_ndt
