#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "localization/synthetic_drive.h"
#include "map/map_fixtures.h"
#include "run_app_program.h"

namespace saw_ndt {

/// Everything in a folder and below it: the content of each file, by its path.
inline std::map<std::string, std::string> filesIn(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    files[entry.path().string()] = entry.is_regular_file() ? contentOf(entry.path()) : "";
  }
  return files;
}

/// A short VLP-16 drive in a temporary folder, and shell text to run apps on it.
class DriveFiles : public ::testing::Test {
 protected:
  static constexpr char kSensor[] = " -sensor VLP-16 -threads 1 ";

  DriveFiles() { writeKittiDrive(drive_folder, driveDownTheStreet(SensorModel::named("VLP-16"), 6)); }

  static std::string quoted(const std::filesystem::path& path) { return "'" + path.string() + "' "; }

  void replace(const std::string& name, const std::string& content) const {
    std::ofstream(drive_folder / name, std::ios::binary) << content;
  }

  /// Expects exit code and reason of an app that fails, in one line on stderr but for that of the setup, and that no
  /// file has come, gone or changed.
  void expectFails(const std::string& program, const std::string& arguments, int exit_code,
                   std::initializer_list<std::string> parts) const {
    SCOPED_TRACE(arguments);
    const auto before = filesIn(folder.path());
    const AppResult result = runAppProgram(program, arguments);
    EXPECT_EQ(result.exit_code, exit_code) << result.errors;
    const std::string errors = withoutSetup(result.errors);
    EXPECT_EQ(std::count(errors.begin(), errors.end(), '\n'), 1) << errors;
    for (const std::string& part : parts) {
      EXPECT_NE(errors.find(part), std::string::npos) << "'" << errors << "' lacks '" << part << "'";
    }
    EXPECT_EQ(result.output, "");
    EXPECT_TRUE(filesIn(folder.path()) == before) << "files have changed";
  }

  TemporaryFolder folder;
  const std::filesystem::path drive_folder = folder.path() / "drive";
};

}  // namespace saw_ndt
