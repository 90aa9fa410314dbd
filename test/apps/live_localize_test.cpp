#include <signal.h>

#include <algorithm>
#include <boost/asio/ip/udp.hpp>
#include <boost/process/child.hpp>
#include <boost/process/search_path.hpp>
#include <chrono>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "drive_files.h"
#include "saw_ndt/evaluation/metrics.h"
#include "saw_ndt/io/trajectory.h"

namespace saw_ndt {
namespace {

namespace bp = boost::process;

class LiveLocalizeApp : public DriveFiles {
 protected:
  static constexpr int kScans = 6;

  void SetUp() override {
    const AppResult result = runAppProgram(SAW_NDT_BUILD_MAP_APP, quoted(drive_folder) + quoted(map_file) + kSensor);
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    std::filesystem::create_directory(live_folder);
  }

  /// Starts the program on the folder that grows, as words typed into a shell.
  bp::child start(const std::string& options) const {
    const std::string arguments = quoted(live_folder) + quoted(map_file) + quoted(out) + kSensor +
                                  " -follow -initial-pose 0,0,0,0,0,0 -skip 0 -max-waiting 100 " + options;
    return bp::child(bp::exe = SAW_NDT_APP, bp::args = boost::program_options::split_unix(arguments),
                     bp::std_in<bp::null, bp::std_out> outputs.string(), bp::std_err > errors.string());
  }

  /// Moves a scan of the drive into the folder, named by its stamp.
  void give(int scan) const {
    const std::filesystem::path part = folder.path() / "part";
    std::filesystem::copy_file(drive_folder / "velodyne" / ("00000" + std::to_string(scan) + ".bin"), part);
    std::filesystem::rename(part, live_folder / ("170000000" + std::to_string(scan) + ".0.bin"));
  }

  /// Waits until a file has so many lines.
  static bool waitForLines(const std::filesystem::path& file, std::ptrdiff_t lines) {
    for (int i = 0; i < 3000; ++i) {
      const std::string content = std::filesystem::exists(file) ? contentOf(file) : "";
      if (std::count(content.begin(), content.end(), '\n') >= lines) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
  }

  int interrupt(bp::child& program, int signal) const {
    kill(program.id(), signal);
    program.wait();
    return program.exit_code();
  }

  const std::filesystem::path map_file = folder.path() / "a.map", live_folder = folder.path() / "live",
                              out = folder.path() / "out", outputs = folder.path() / "stdout",
                              errors = folder.path() / "stderr", stream = folder.path() / "poses";
};

TEST_F(LiveLocalizeApp, PosesComeScanByScanAndAnInterruptionWritesAllResults) {
  bp::child program = start("-stream " + quoted(stream));
  for (int scan = 0; scan < kScans; ++scan) {
    give(scan);
    // The first five tell of the sensor before any is localized.
    if (scan >= 4) {
      ASSERT_TRUE(waitForLines(stream, scan + 1)) << contentOf(errors);
    }
  }
  EXPECT_TRUE(program.running());
  EXPECT_EQ(interrupt(program, SIGINT), 0) << contentOf(errors);

  std::istringstream lines(contentOf(stream));
  std::string line;
  for (int scan = 0; scan < kScans; ++scan) {
    ASSERT_TRUE(std::getline(lines, line));
    const nlohmann::json pose = nlohmann::json::parse(line);
    EXPECT_EQ(pose.at("scan"), scan);
    EXPECT_EQ(pose.at("stamp"), 1700000000.0 + scan);
    EXPECT_EQ(pose.at("state"), "tracking") << line;
    EXPECT_EQ(pose.at("left_out"), 0);
    EXPECT_LT(pose.at("sigma_xyz_m")[0], 0.1);
    EXPECT_EQ(pose.at("position_m").size(), 3U);
  }
  EXPECT_FALSE(std::getline(lines, line));
  const nlohmann::json summary = nlohmann::json::parse(contentOf(out / "summary.json"));
  EXPECT_EQ(summary.at("scans"), kScans);
  EXPECT_EQ(summary.at("accepted"), kScans);
  EXPECT_EQ(summary.at("left_out"), 0);
  EXPECT_EQ(contentOf(outputs), contentOf(out / "summary.json"));
  EXPECT_EQ(filesIn(out).size(), 4U);
}

TEST_F(LiveLocalizeApp, TumLinesOnStdoutAreTheTrajectory) {
  bp::child program = start("-stream - -stream-format tum");
  for (int scan = 0; scan < kScans; ++scan) give(scan);
  ASSERT_TRUE(waitForLines(outputs, 2 * kScans)) << contentOf(errors);
  EXPECT_EQ(interrupt(program, SIGTERM), 0) << contentOf(errors);
  std::istringstream lines(contentOf(outputs));
  std::string poses;
  for (std::string line; std::getline(lines, line);) {
    if (line.front() != '#') {
      poses += line + '\n';
      continue;
    }
    EXPECT_NE(line.find("tracking accepted sigma_xyz_m 0."), std::string::npos) << line;
  }
  EXPECT_EQ(poses, contentOf(out / "trajectory_tum.txt"));
}

TEST_F(LiveLocalizeApp, InterruptedBeforeAnyScanItFailsAndLeavesNothing) {
  bp::child program = start("");
  ASSERT_TRUE(waitForLines(errors, 1));
  EXPECT_EQ(interrupt(program, SIGINT), 1);
  EXPECT_NE(contentOf(errors).find("no scan came"), std::string::npos) << contentOf(errors);
  EXPECT_FALSE(std::filesystem::exists(out));
}

/// A UDP port that nobody listens to.
int freePort() {
  boost::asio::io_context context;
  return boost::asio::ip::udp::socket(context, {boost::asio::ip::make_address("127.0.0.1"), 0}).local_endpoint().port();
}

TEST_F(LiveLocalizeApp, AVelodyneOverUdpGivesThePosesOfItsCapture) {
  const std::string python = bp::search_path("python3").string();
  if (python.empty()) GTEST_SKIP() << "no python3, which writes and replays the capture";
  const std::string capture = quoted(folder.path() / "drive.pcap");
  const std::string scripts = SAW_NDT_SOURCE_DIR "/test/recordings/";
  const AppResult written =
      runAppProgram(python, "'" + scripts + "write_velodyne_capture.py' " + quoted(drive_folder) + capture);
  ASSERT_EQ(written.exit_code, 0) << written.errors;
  // The drive has no motion in its scans. What is found of a scan depends a little on its stamp, which is that of
  // today.
  const std::string options =
      quoted(map_file) + quoted(out) + " -initial-pose 0,0,0,0,0,0 -skip 0 -motion-compensation off -threads 1 ";
  const AppResult recorded = runAppProgram(SAW_NDT_APP, capture + options);
  if (recorded.errors.find("libpcap") != std::string::npos) GTEST_SKIP() << recorded.errors;
  ASSERT_EQ(recorded.exit_code, 0) << recorded.errors;
  const std::vector<StampedPose> expected = readTumTrajectory(out / "trajectory_tum.txt");
  ASSERT_GE(expected.size(), 5U);

  const std::string port = std::to_string(freePort());
  bp::child program(bp::exe = SAW_NDT_APP,
                    bp::args = boost::program_options::split_unix("udp:127.0.0.1:" + port + ' ' + options +
                                                                  "-max-waiting 100 -stream " + quoted(stream)),
                    bp::std_in<bp::null, bp::std_out> outputs.string(), bp::std_err > errors.string());
  ASSERT_TRUE(waitForLines(errors, 1));
  const AppResult replayed = runAppProgram(python, "'" + scripts + "replay_capture.py' " + capture + port);
  ASSERT_EQ(replayed.exit_code, 0) << replayed.errors;
  // The capture's last turn is over where the file ends; a live one has no end but the next turn.
  const std::size_t turns = expected.size() - 1;
  EXPECT_TRUE(waitForLines(stream, static_cast<std::ptrdiff_t>(turns))) << contentOf(errors);
  EXPECT_EQ(interrupt(program, SIGINT), 0) << contentOf(errors);
  const std::vector<StampedPose> found = readTumTrajectory(out / "trajectory_tum.txt");
  ASSERT_EQ(found.size(), turns);
  for (std::size_t i = 0; i < turns; ++i) {
    const PoseError error = poseError(expected[i].T_map_body, found[i].T_map_body);
    EXPECT_LT(error.position_m, 0.001) << i;
    EXPECT_LT(error.yaw_deg, 0.01) << i;
  }
  EXPECT_EQ(nlohmann::json::parse(contentOf(out / "summary.json")).at("left_out"), 0);
}

TEST_F(LiveLocalizeApp, RecordedRunsCanBeStreamedToo) {
  const AppResult result = runAppProgram(SAW_NDT_APP, quoted(drive_folder) + quoted(map_file) + quoted(out) + kSensor +
                                                          "-skip 0 -stream " + quoted(stream) + "-stream-format tum");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(readTumTrajectory(stream).size(), static_cast<std::size_t>(kScans));
}

TEST_F(LiveLocalizeApp, WhatExcludesALiveSourceIsWrongUsage) {
  const std::string files = quoted(live_folder) + quoted(map_file) + quoted(out) + kSensor + "-follow ";
  expectFails(SAW_NDT_APP, files, 2, {"no reference poses", "-initial-pose"});
  expectFails(SAW_NDT_APP, files + "-initial-pose unknown -scans 0", 2, {"-scans", "excludes a live source"});
  expectFails(SAW_NDT_APP, files + "-initial-pose unknown -max-waiting 0", 2, {"max-waiting"});
  expectFails(SAW_NDT_APP, files + "-initial-pose unknown -stream " + quoted(folder.path() / "none" / "poses"), 1,
              {"none/poses", "No such file"});
}

}  // namespace
}  // namespace saw_ndt
