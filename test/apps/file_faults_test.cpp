// What every program does with files that are none, that it may not read, or that cannot be written.

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <string>
#include <vector>

#include "drive_files.h"
#include "report/gnuplot.h"
#include "run_app_program.h"

namespace saw_ndt {
namespace {

namespace fs = std::filesystem;

class FileFaults : public DriveFiles {
 protected:
  FileFaults() { build("old.map", " -resolution 1"); }

  std::string path(const std::string& name) const { return quoted(folder.path() / name); }

  static std::string app(const std::string& verb) { return std::string(SAW_NDT_APPS "/saw_ndt_") + verb + ' '; }

  void build(const std::string& name, const std::string& options) const {
    ASSERT_EQ(run(app("build_map") + quoted(drive_folder) + path(name) + kSensor + options).exit_code, 0);
  }

  static AppResult run(const std::string& command) { return runAppProgram("/usr/bin/env", command); }

  static AppResult runShell(const std::string& command) { return runAppProgram("/bin/bash", "-c \"" + command + "\""); }

  /// Command lines of programs, each with one input file called {}.EXTENSION.
  std::vector<std::string> commandsWithAnInput() const {
    const std::string drive = quoted(drive_folder), scan = quoted(drive_folder / "velodyne" / "000000.bin"),
                      map = path("old.map"), out = path("out"), poses = quoted(drive_folder / "poses.txt");
    std::vector<std::string> commands = {
        app("segment") + "{}.bin " + out,
        app("segment") + "{}.pcd " + out,
        app("segment") + scan + out + "-labels {}.label",
        app("align") + "{}.ply " + scan,
        app("align") + scan + "{}.pcd",
        app("build_map") + "{}.bag " + out,
        app("build_map") + "{}.db3 " + out,
        app("build_map") + "{}.mcap " + out,
        app("build_map") + "{}.pcap " + out,
        app("build_map") + drive + out + "-poses {}.txt",
        app("localize") + "{}.bag " + map + out,
        app("localize") + drive + "{}.map " + out,
        app("localize") + drive + map + out + "-odometry {}.txt",
        app("localize") + drive + map + out + "-gnss {}.txt",
        app("map_pack") + "{}.map " + out,
        app("map_merge") + out + "{}.map",
        app("map_merge") + "-update {}.map " + map,
        app("map_merge") + "-update " + map + "{}.map",
        app("map_crop") + "{}.map " + out + "-box 0,0,1,1",
        app("map_crop") + map + out + "-polygon {}.txt",
        app("map_crop") + map + out + "-around {}.txt -radius 5",
        app("map_import") + "{}.pcd " + out,
        app("map_remove_moved") + "{}.map " + out + drive,
        app("map_remove_moved") + map + out + "{}.bag",
        app("map_diff") + "{}.map " + map,
        app("map_info") + "{}.map",
        app("map_info") + map + "-config {}.txt",
        app("evaluate") + "{}.txt " + poses,
        app("evaluate") + poses + "{}.txt",
        app("benchmark") + "{}.bag -output " + out,
    };
#if SAW_NDT_HAS_SIMULATE
    for (const char* option : {"-scene {}.json", "-sensor {}.json", "-trajectory {}.txt"}) {
      commands.push_back(app("simulate") + out + option);
    }
#endif
    return commands;
  }

  /// @param input  what stands in the place of {}
  /// @param user   words before the program
  void expectRefused(std::string command, const std::string& input, const std::string& reason,
                     const std::string& user = "") const {
    command.replace(command.find("{}"), 2, (folder.path() / input).string());
    SCOPED_TRACE(command);
    const auto before = filesIn(folder.path());
    const AppResult result = runAppProgram("/usr/bin/timeout", "20 " + user + command);
    const std::string errors = withoutSetup(result.errors);
    // A scene may be the name of one: what is neither is wrong usage.
    const bool is_scene = command.find("-scene") != std::string::npos;
    EXPECT_EQ(result.exit_code, is_scene ? 2 : 1) << errors;
    EXPECT_EQ(std::count(errors.begin(), errors.end(), '\n'), 1) << errors;
    EXPECT_NE(errors.find(input), std::string::npos) << errors;
    EXPECT_NE(errors.find(is_scene ? "neither a file nor" : reason), std::string::npos) << errors;
    EXPECT_EQ(errors.find("filesystem error"), std::string::npos) << errors;
    EXPECT_TRUE(filesIn(folder.path()) == before) << "files have changed";
  }

  /// Makes the input of a command, whatever its extension, by a function of its path.
  template <typename Make>
  void expectAllRefused(const std::string& input, const std::string& reason, const Make& make) const {
    for (const std::string& command : commandsWithAnInput()) {
      const std::size_t dot = command.find("{}") + 2;
      const fs::path file = (folder.path() / input).string() + command.substr(dot, command.find(' ', dot) - dot);
      if (!fs::exists(fs::symlink_status(file))) make(file);
      expectRefused(command, input, reason);
    }
  }
};

TEST_F(FileFaults, AFolderIsNoInputFile) {
  expectAllRefused("folder", "", [](const fs::path& file) { fs::create_directory(file); });
}

TEST_F(FileFaults, APipeThatNobodyWritesIntoIsRefusedAtOnce) {
  expectAllRefused("pipe", "", [](const fs::path& file) { mkfifo(file.c_str(), 0600); });
}

TEST_F(FileFaults, ADeviceThatNeverEndsIsRefusedAtOnce) {
  expectAllRefused("device", "", [](const fs::path& file) { fs::create_symlink("/dev/zero", file); });
}

class FileFaultsOfAnotherUser : public FileFaults {
 protected:
  void SetUp() override {
    if (getuid() != 0) GTEST_SKIP() << "only the superuser can become another user";
    fs::create_directory(folder.path() / "closed");
    fs::permissions(folder.path() / "closed", fs::perms(0700));
    fs::permissions(folder.path(), fs::perms(0777));
    fs::permissions(folder.path() / "old.map", fs::perms(0666));
  }
  void expectDenied(const std::string& command) const {
    expectRefused(command, "closed/a", "Permission denied", "setpriv --reuid 65534 --regid 65534 --clear-groups ");
  }
};

TEST_F(FileFaultsOfAnotherUser, WhatMayNotBeReadIsToldInOneLine) {
  for (const std::string& command : commandsWithAnInput()) expectDenied(command);
}

TEST_F(FileFaultsOfAnotherUser, WhatMayNotBeWrittenIsToldInOneLine) {
  const std::string drive = quoted(drive_folder), map = path("old.map"), poses = quoted(drive_folder / "poses.txt");
  for (const std::string& command :
       {app("build_map") + drive + "{}.map", app("map_pack") + map + "{}.map", app("map_merge") + "{}.map " + map,
        app("map_crop") + map + "{}.map -box 0,0,1,1", app("map_info") + map + "-pcd {}.pcd",
        app("map_diff") + map + map + "-pcd {}.pcd", app("localize") + drive + map + "{}.folder",
        app("evaluate") + poses + poses + "-skip 0 -plot {}.folder",
        app("benchmark") + drive + "-skip 0 -output {}.folder"}) {
    expectDenied(command);
  }
}

TEST_F(FileFaults, ADiskThatIsFullLeavesTheOldResults) {
  build("one.map", "");
  const std::string drive = quoted(drive_folder), one = path("one.map");
  const std::string scan = quoted(drive_folder / "velodyne" / "000000.bin");
  ASSERT_EQ(run(app("map_info") + one + "-pcd " + path("cloud.pcd")).exit_code, 0);
  folder.write("out", "old");
  folder.write("run/summary.json", "old");
  for (const std::string& command :
       {app("build_map") + drive + path("out") + kSensor, app("map_pack") + one + path("out"),
        app("map_merge") + path("out") + one, app("map_crop") + one + path("out") + "-box -20,-20,20,20",
        app("map_import") + path("cloud.pcd") + path("out"), app("segment") + scan + path("out") + kSensor,
        app("map_info") + one + "-pcd " + path("out"),

        app("map_remove_moved") + one + path("out") + drive,
        app("localize") + drive + one + path("run") + "-skip 0" + kSensor}) {
    SCOPED_TRACE(command);
    const auto before = filesIn(folder.path());
    const AppResult result = runShell("ulimit -f 1; exec " + command);
    EXPECT_EQ(result.exit_code, 1) << result.errors;
    EXPECT_NE(result.errors.find("File too large"), std::string::npos) << result.errors;
    EXPECT_TRUE(filesIn(folder.path()) == before) << "files have changed";
  }
}

TEST_F(FileFaults, AMapOfNoPointIsRefusedAndTheOldOneStays) {
  for (const char* options : {"-resolution 1e-30", "-resolution 1e-30 -classical"}) {
    expectFails("/usr/bin/env", app("build_map") + quoted(drive_folder) + path("old.map") + kSensor + options, 2,
                {"resolution_m = 1e-30"});
  }
  std::string far;
  for (int i = 0; i < 6; ++i) far += "1 0 0 1e20 0 1 0 1e20 0 0 1 1e20\n";
  replace("poses.txt", far);
  expectFails("/usr/bin/env", app("build_map") + quoted(drive_folder) + path("old.map") + kSensor, 1, {"no point"});
}

TEST_F(FileFaults, AMapKeepsItsModeWhenItIsBuiltAgain) {
  fs::permissions(folder.path() / "old.map", fs::perms(0600));
  build("old.map", "");
  EXPECT_EQ(fs::status(folder.path() / "old.map").permissions(), fs::perms(0600));
}

TEST_F(FileFaults, NamesOf250CharactersAreWritten) {
  const std::string name(246, 'n'), map = path("old.map");
  EXPECT_EQ(run(app("map_pack") + map + path(name + ".loc")).exit_code, 0);
  EXPECT_EQ(run(app("map_info") + map + "-pcd " + path(name + ".pcd")).exit_code, 0);
  if (gnuplotFound()) {
    const AppResult drawn = run(app("map_info") + map + "-picture " + path(name + ".png"));
    EXPECT_EQ(drawn.exit_code, 0) << drawn.errors;
    EXPECT_TRUE(fs::exists(folder.path() / (name + ".png")));
  }
}

}  // namespace
}  // namespace saw_ndt
