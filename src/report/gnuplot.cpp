#include "report/gnuplot.h"

#include <algorithm>
#include <boost/process/io.hpp>
#include <boost/process/search_path.hpp>
#include <boost/process/system.hpp>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <system_error>

#include "common/atomic_output.h"
#include "io/staged_output.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {

using namespace internal;

namespace fs = std::filesystem;

namespace {

constexpr char kFont[] = "DejaVu Sans,11";

std::string inSingleQuotes(const std::string& text, const std::string& quote_within) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? quote_within : std::string(1, c);
  return result + "'";
}

std::string pngTerminal() {
  std::ostringstream text;
  text << "pngcairo fontscale " << kPngScale << " linewidth " << kPngScale << " pointscale " << kPngScale;
  return text.str();
}

/// @param scale  of the picture's size
std::string drawn(const GnuplotPicture& picture, const std::string& terminal, double scale, const fs::path& file) {
  std::ostringstream script;
  script << "reset\nset terminal " << terminal << " noenhanced background rgb 'white' size " << scale * picture.width_px
         << ',' << scale * picture.height_px << " font " << gnuplotQuoted(kFont) << "\nset encoding utf8\nset output "
         << gnuplotQuoted(file.string()) << "\n"
         << picture.commands << "\nunset output\n";
  return script.str();
}

std::string firstLineOf(const fs::path& file) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (line.find_first_not_of(" \t^") != std::string::npos) return line;
  }
  return "failed without a word";
}

/// Files that go with this object.
struct Scratch {
  std::vector<fs::path> files;
  ~Scratch() {
    std::error_code ignored;
    for (const fs::path& file : files) fs::remove(file, ignored);
  }
};

}  // namespace

bool gnuplotFound() { return !boost::process::search_path("gnuplot").empty(); }

void drawPicture(const GnuplotPicture& picture, const fs::path& folder) {
  const fs::path script_file = folder / (picture.name + ".gnuplot"), message_file = folder / (picture.name + ".log");
  const Scratch scratch{{script_file, message_file}};
  // A file rather than a pipe, which would end this process where gnuplot gives up early.
  AtomicOutput script(script_file);
  script.stream() << picture.data << drawn(picture, pngTerminal(), kPngScale, folder / (picture.name + ".png"));
  if (!picture.many_points) script.stream() << drawn(picture, "svg", 1.0, folder / (picture.name + ".svg"));
  script.commit();
  namespace bp = boost::process;
  const int exit_code = bp::system(bp::search_path("gnuplot"), script_file.string(),
                                   bp::std_in<bp::null, bp::std_out> bp::null, bp::std_err > message_file.string());
  if (exit_code != 0) throw Error("gnuplot", picture.name, firstLineOf(message_file));
}

void drawPng(GnuplotPicture picture, const fs::path& file) {
  StagedOutput output(file.has_parent_path() ? file.parent_path() : fs::path("."));
  picture.name = "picture";  // what gnuplot writes beside it has a longer name than its own
  picture.many_points = true;
  drawPicture(picture, output.folder());
  fs::rename(output.folder() / "picture.png", output.folder() / file.filename());
  output.commit();
}

std::string gnuplotQuoted(const std::string& text) {
  std::string line = text;
  std::replace(line.begin(), line.end(), '\n', ' ');
  return inSingleQuotes(line, "''");
}

std::string gnuplotData(const std::string& name, const std::vector<std::vector<double>>& columns) {
  std::ostringstream text;
  text << name << " << END_OF_DATA\n" << std::setprecision(9);
  for (std::size_t row = 0; row < columns.front().size(); ++row) {
    for (const std::vector<double>& column : columns) text << column[row] << ' ';
    text << '\n';
  }
  text << "END_OF_DATA\n";
  return text.str();
}

}  // namespace saw_ndt
