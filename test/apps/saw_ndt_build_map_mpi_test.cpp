#include <signal.h>
#include <stdlib.h>

#include <boost/process/child.hpp>
#include <chrono>
#include <optional>
#include <thread>

#include "drive_files.h"

namespace saw_ndt {
namespace {

namespace bp = boost::process;

// The process of a rank of a job that names this map; nothing where it has not begun or has ended.
std::optional<pid_t> processOfRank(int rank, const std::filesystem::path& map_file) {
  const std::string variable = "OMPI_COMM_WORLD_RANK=" + std::to_string(rank);
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    std::error_code ignored;
    if (std::filesystem::read_symlink(entry.path() / "exe", ignored) != SAW_NDT_APP) continue;
    const auto holds = [](const std::string& words, const std::string& word) {
      return ('\0' + words).find('\0' + word + '\0') != std::string::npos;
    };
    if (holds(contentOf(entry.path() / "cmdline"), map_file.string()) &&
        holds(contentOf(entry.path() / "environ"), variable)) {
      return static_cast<pid_t>(std::stol(name));
    }
  }
  return std::nullopt;
}

class BuildMapMpiApp : public DriveFiles {
 protected:
  static void SetUpTestSuite() {
    // What mpirun's options --oversubscribe and --allow-run-as-root say.
    setenv("OMPI_MCA_rmaps_base_oversubscribe", "1", 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
  }

  BuildMapMpiApp() { writeKittiDrive(other_folder, driveDownTheStreet(SensorModel::named("VLP-16"), 9)); }

  std::string drives() const { return quoted(drive_folder) + quoted(other_folder); }
  static std::string jobOf(int ranks, const std::string& arguments) {
    return "-n " + std::to_string(ranks) + " '" SAW_NDT_APP "' " + arguments;
  }
  static AppResult run(int ranks, const std::string& arguments) {
    return runAppProgram(SAW_NDT_MPIEXEC, jobOf(ranks, arguments));
  }
  std::string expected(const std::string& arguments) const {
    const std::filesystem::path file = folder.path() / "expected.map";
    const AppResult result = runAppProgram(SAW_NDT_BUILD_MAP_APP, drives() + quoted(file) + arguments);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    const std::string bytes = contentOf(file);
    std::filesystem::remove(file);
    return bytes;
  }

  const std::filesystem::path other_folder = folder.path() / "other";
  const std::filesystem::path map_file = folder.path() / "a.map";
};

TEST_F(BuildMapMpiApp, AnyNumberOfRanksWritesTheSameBytes) {
  for (const std::string options : {"", "-classical -scans ::2", "-shard 2/3 -sensor VLP-16"}) {
    SCOPED_TRACE(options);
    const std::string bytes = expected(options);
    for (const int ranks : {1, 2, 4}) {
      const AppResult result = run(ranks, drives() + quoted(map_file) + "-threads 1 " + options);
      ASSERT_EQ(result.exit_code, 0) << result.errors;
      EXPECT_NE(result.output.find("ranks " + std::to_string(ranks) + ": "), std::string::npos) << result.output;
      EXPECT_TRUE(contentOf(map_file) == bytes) << ranks;
      EXPECT_EQ(folder.entryCount(), 3U) << ranks;
      std::filesystem::remove(map_file);
    }
  }
}

TEST_F(BuildMapMpiApp, MoreRanksThanScansAndThreadsInRanks) {
  const std::string bytes = expected("-scans 0:1");
  const AppResult result = run(5, drives() + quoted(map_file) + "-scans 0:1 -threads 2");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_TRUE(contentOf(map_file) == bytes);
}

TEST_F(BuildMapMpiApp, WhatIsWrongFromTheBeginningIsSaidOnce) {
  folder.write("a.map", "an old map");
  const auto expectSaid = [&](const std::string& arguments, int exit_code, const std::string& part) {
    const AppResult result = run(3, arguments);
    EXPECT_EQ(result.exit_code, exit_code) << result.errors;
    const std::size_t place = result.errors.find("saw_ndt_build_map_mpi: ");
    ASSERT_NE(result.errors.find(part), std::string::npos) << result.errors;
    EXPECT_EQ(result.errors.find("saw_ndt_build_map_mpi: ", place + 1), std::string::npos) << result.errors;
    EXPECT_EQ(contentOf(map_file), "an old map");
  };
  expectSaid(quoted(drive_folder), 2, "missing MAP");
  expectSaid(quoted(drive_folder) + quoted(map_file) + "-resolution fine", 2, "-resolution");
  expectSaid(quoted(folder.path() / "none") + quoted(map_file), 1, "none: No such file");
  const AppResult help = run(2, "-h");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_EQ(help.output.find("Usage: saw_ndt_build_map_mpi SEQUENCE... MAP"), help.output.rfind("Usage: "));
}

TEST_F(BuildMapMpiApp, ScansThatCannotBeReadAreLeftOutOrEndTheJob) {
  replace("velodyne/000005.bin", "");
  const std::string bytes = expected("");
  AppResult result = run(2, drives() + quoted(map_file));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.errors.find("000005.bin: offset 0: the file is empty: left out\n"), std::string::npos);
  EXPECT_NE(result.output.find("of 14 scans, 1 left out\n"), std::string::npos) << result.output;
  EXPECT_TRUE(contentOf(map_file) == bytes);
  std::filesystem::remove(map_file);

  result = run(2, drives() + quoted(map_file) + "-strict");
  EXPECT_EQ(result.exit_code, 1);
  const std::regex said(
      "saw_ndt_build_map_mpi: rank [01] \\([^)]+\\): [^\n]*000005.bin: offset 0: the file is empty\n");
  EXPECT_TRUE(std::regex_search(result.errors, said)) << result.errors;
  EXPECT_EQ(folder.entryCount(), 2U);
}

TEST_F(BuildMapMpiApp, ARankThatIsKilledEndsTheJobAndLeavesNothing) {
  for (const int victim : {1, 0}) {
    const std::filesystem::path out = folder.path() / "out", err = folder.path() / "err";
    bp::child job(bp::exe = SAW_NDT_MPIEXEC,
                  bp::args = boost::program_options::split_unix(jobOf(3, drives() + quoted(map_file))),
                  bp::std_in<bp::null, bp::std_out> out.string(), bp::std_err > err.string());
    std::optional<pid_t> process;
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!(process = processOfRank(victim, map_file)) && std::chrono::steady_clock::now() < give_up) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ASSERT_TRUE(process);
    // No job ends without a rank that stands still.
    kill(*process, SIGSTOP);
    std::this_thread::sleep_for(std::chrono::seconds(1));
    EXPECT_TRUE(job.running());
    kill(*process, SIGKILL);
    job.wait();
    EXPECT_NE(job.exit_code(), 0);
    const std::string errors = contentOf(err);
    EXPECT_NE(errors.find("rank " + std::to_string(victim)), std::string::npos) << errors;
    EXPECT_NE(errors.find("signal 9"), std::string::npos) << errors;
    std::filesystem::remove(out);
    std::filesystem::remove(err);
    EXPECT_EQ(folder.entryCount(), 2U);
  }
}

}  // namespace
}  // namespace saw_ndt
