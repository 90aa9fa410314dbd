#pragma once

#include <boost/process/args.hpp>
#include <boost/process/exe.hpp>
#include <boost/process/io.hpp>
#include <boost/process/system.hpp>
#include <boost/program_options/parsers.hpp>
#include <fstream>
#include <regex>
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

/// Runs a program; `arguments` are words as typed into a shell. Its stdout goes to `output_file` where one is named.
inline AppResult runAppProgram(const std::string& program, const std::string& arguments,
                               const std::string& output_file = "") {
  namespace bp = boost::process;
  const TemporaryFolder folder;
  const std::string out = output_file.empty() ? (folder.path() / "out").string() : output_file;
  const std::string err = (folder.path() / "err").string();
  const int exit_code = bp::system(bp::exe = program, bp::args = boost::program_options::split_unix(arguments),
                                   bp::std_in<bp::null, bp::std_out> out, bp::std_err > err);
  const auto contentOf = [](const std::string& path) {
    std::ostringstream content;
    content << std::ifstream(path).rdbuf();
    return content.str();
  };
  return {exit_code, output_file.empty() ? contentOf(out) : "", contentOf(err)};
}

/// What a program said on stderr but for the line that tells of the sensor and its mounting.
inline std::string withoutSetup(const std::string& errors) {
  return std::regex_replace(errors, std::regex("saw_ndt_\\w+: sensor: [^\n]*; mounting: [^\n]*\n"), "");
}

}  // namespace saw_ndt
