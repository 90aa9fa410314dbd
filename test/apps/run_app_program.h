#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "temporary_folder.h"

namespace saw_ndt {

/// What a program did.
struct AppResult {
  int exit_code;
  std::string output;  ///< on stdout
  std::string errors;  ///< on stderr
};

/// Runs a program through the shell; `arguments` is shell text. Its stdout goes to `output_file` where one is named.
inline AppResult runAppProgram(const std::string& program, const std::string& arguments,
                               const std::string& output_file = "") {
  const TemporaryFolder folder;
  const auto out = output_file.empty() ? folder.path() / "out" : std::filesystem::path(output_file);
  const auto err = folder.path() / "err";
  const std::string command = "'" + program + "' " + arguments + " > '" + out.string() + "' 2> '" + err.string() + "'";
  const int status = std::system(command.c_str());
  const auto contentOf = [](const std::filesystem::path& path) {
    std::ostringstream content;
    content << std::ifstream(path).rdbuf();
    return content.str();
  };
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, output_file.empty() ? contentOf(out) : "", contentOf(err)};
}

}  // namespace saw_ndt
