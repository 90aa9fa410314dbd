#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/run_app_program.h"
#include "map/map_fixtures.h"
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
  /// How far poses may be from those of the reference (m and rad); 0: the same bytes. Where poses are given in degrees
  /// of latitude or as a chain of transforms, they are rounded otherwise, and an alignment ends some micrometres off.
  double tolerance = 0.0;
  bool is_cut = false;  ///< to the first scans of the drive
};

void PrintTo(const Form& form, std::ostream* out) { *out << form.name; }

/// What the programs make of a recording.
struct Outcome {
  std::string map, trajectory_text;  // the bytes of the files
  std::vector<StampedPose> trajectory;
};

const fs::path kRecordings = SAW_NDT_RECORDINGS;

std::string quoted(const fs::path& path) { return "'" + path.string() + "' "; }

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
  if (form.tolerance == 0.0) {
    EXPECT_TRUE(found.map == expected.map)
        << "maps of " << found.map.size() << " and " << expected.map.size() << " bytes differ";
    EXPECT_EQ(found.trajectory_text, expected.trajectory_text);
    return;
  }
  ASSERT_EQ(found.trajectory.size(), expected.trajectory.size());
  for (std::size_t i = 0; i < found.trajectory.size(); ++i) {
    EXPECT_EQ(found.trajectory[i].stamp_s, expected.trajectory[i].stamp_s) << "scan " << i;
    const Eigen::Isometry3d off = expected.trajectory[i].T_map_body.inverse() * found.trajectory[i].T_map_body;
    EXPECT_LE(off.translation().norm(), form.tolerance) << "scan " << i;
    EXPECT_LE(Eigen::AngleAxisd(off.linear()).angle(), form.tolerance) << "scan " << i;
  }
}

constexpr char kTopic[] = "-topic /points";
constexpr double kRounded = 1e-4;

INSTANTIATE_TEST_SUITE_P(
    All, RecordingForm,
    ::testing::Values(Form{"KittiRaw", "kitti_raw/2023_11_14/2023_11_14_drive_0001_sync", "", kRounded},
                      Form{"PcdByStamps", "pcd_stamps", ""}, Form{"PcdByNumbers", "pcd_numbers", ""},
                      Form{"Ply", "ply", ""}, Form{"AsciiPly", "ply_ascii", "", 0.0, true},
                      Form{"Ros1", "ros1/none.bag", kTopic}, Form{"Ros1Bz2", "ros1/bz2.bag", kTopic},
                      Form{"Ros1Lz4", "ros1/lz4.bag", kTopic}, Form{"Ros1Tf", "ros1/tf.bag", kTopic, kRounded},
                      Form{"Ros2Db3", "ros2_db3", kTopic},
                      Form{"Ros2Db3Tf", "ros2_db3_tf/ros2_db3_tf_0.db3", kTopic, kRounded},
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
