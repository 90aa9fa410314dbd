#include "report/benchmark_report.h"

#include <iterator>
#include <optional>
#include <sstream>
#include <system_error>

#include "common/atomic_output.h"
#include "common/input_file.h"
#include "report/benchmark_pictures.h"
#include "report/html.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {

using namespace internal;

namespace fs = std::filesystem;

namespace {

constexpr char kHead[] = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Localization benchmark</title>
<style>
body { font: 16px/1.5 system-ui, "DejaVu Sans", sans-serif; color: #222; max-width: 1240px; margin: 2em auto; padding: 0 1em; }
h1, h2, h3 { line-height: 1.25; }
h2 { margin-top: 2.2em; border-bottom: 1px solid #ddd; padding-bottom: .2em; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: 14px; font-variant-numeric: tabular-nums; }
th, td { padding: .3em .7em; border-bottom: 1px solid #e3e3e3; text-align: right; white-space: nowrap; }
th { background: #f5f5f5; vertical-align: bottom; white-space: normal; }
th:first-child, td:first-child, td.method, th.method { text-align: left; }
tr.first td { border-top: 2px solid #999; }
pre { background: #f5f5f5; padding: .8em 1em; overflow-x: auto; font-size: 13px; }
figure { margin: 1.6em 0; }
figure img { max-width: 100%; height: auto; border: 1px solid #e3e3e3; }
figcaption { color: #444; font-size: 14px; max-width: 60em; }
p, ul, dl { max-width: 52em; }
dt { font-weight: bold; }
.missing { background: #fff3cd; padding: .6em 1em; }
</style>
</head>
<body>
)";

constexpr char kHowToRead[] = R"(<h2>How to read it</h2>
<p>Each method follows each drive through a map built beforehand, one scan after the other, and says where the vehicle
is. Its poses are compared with the reference poses, without aligning the two. Methods take turns scan by scan, so that a
slow moment of the machine hits all of them alike. Less is better, but for the accepted scans and the likelihoods.</p>
<dl>
<dt>Time</dt><dd>from the scan in memory to the pose, segmentation included, reading the file excluded; P95 is the time
that 95 % of the scans stay below. It depends on the machine: compare within a table.</dd>
<dt>ATE/RMSE</dt><dd>absolute trajectory error: root of the mean squared distance from the reference position.</dd>
<dt>Position P95 / max, yaw MAE / P95</dt><dd>the distance that 95 % of the scans stay below, and the greatest; the mean
and 95th percentile of the heading's error, without its sign.</dd>
<dt>Accepted</dt><dd>share of the scans whose pose was trusted. A rejected scan gets the pose predicted for it, and counts
in the errors with that.</dd>
<dt>Likelihood</dt><dd>what the method maximizes, per source point. It changes with weights: compare it within a method.
The nearest-voxel likelihood and the one in the pictures do not change with weights.</dd>
<dt>Source points, segment / filter / align</dt><dd>how many points were aligned, and where the time went.</dd>
<dt>Macro average</dt><dd>the plain mean over the drives.</dd>
</dl>
<p><em>Map of the same drive</em>: as in the paper, a scan may find its own points again in the map, which flatters every
method, unless the command selects different scans for map and test. <em>Map of another drive</em>: the map comes from
another passage along the same streets, as in use.</p>
<p>Methods: <code>classical</code> is NDT without labels; <code>weighted-s50</code> is the paper's method,
<code>weighted-s100</code> keeps all ground points, <code>unweighted-s50</code> does without weights;
<code>weighted</code> is this project's own; <code>pcl-ndt</code>, where present, is
pcl::NormalDistributionsTransform itself on one thread, its source thinned by pcl::VoxelGrid.</p>
)";

constexpr char kNoGnuplot[] = "gnuplot is not installed, so the report has no pictures";

std::string htmlTable(const TextTable& table) {
  std::ostringstream html;
  html << "<h3>" << htmlEscaped(table.title) << "</h3>\n<div class=\"scroll\"><table>\n<tr>";
  const auto cellClass = [&](std::size_t column) {
    return table.header[column] == "Method" ? " class=\"method\"" : "";
  };
  for (std::size_t c = 0; c < table.header.size(); ++c) {
    html << "<th" << cellClass(c) << '>' << htmlEscaped(table.header[c]) << "</th>";
  }
  html << "</tr>\n";
  const bool grouped = table.header.front() != "Method";
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const bool first = grouped && r > 0 && table.rows[r].front() != table.rows[r - 1].front();
    html << (first ? "<tr class=\"first\">" : "<tr>");
    for (std::size_t c = 0; c < table.rows[r].size(); ++c) {
      html << "<td" << cellClass(c) << '>' << htmlEscaped(table.rows[r][c]) << "</td>";
    }
    html << "</tr>\n";
  }
  html << "</table></div>\n";
  return html.str();
}

std::string contentOf(const fs::path& path) {
  std::ifstream stream = openInputFile(path);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string embedded(const GnuplotPicture& picture, const fs::path& plots) {
  const std::string caption = htmlEscaped(picture.caption);
  std::ostringstream html;
  html << "<figure><img width=\"" << picture.width_px << "\" height=\"" << picture.height_px << "\" alt=\"" << caption
       << "\" src=\"data:image/png;base64," << base64(contentOf(plots / (picture.name + ".png"))) << "\">\n<figcaption>"
       << caption << "</figcaption></figure>\n";
  return html.str();
}

/// The section of a run. What gnuplot has to say goes into `failure`.
std::string section(const BenchmarkRun& run, const fs::path& plots, bool draw, std::string& failure) {
  std::ostringstream html;
  html << "<h2>" << htmlEscaped(run.sequence) << ", map of " << (run.drive == MapDrive::SAME ? "the same" : "another")
       << " drive</h2>\n<p>" << run.T_map_base.size() << " scans localized in a map built from " << run.map_scans
       << " scans, by";
  for (const BenchmarkCell& cell : run.cells) {
    html << (&cell == &run.cells.front() ? " <code>" : ", <code>") << htmlEscaped(cell.method) << "</code>";
  }
  html << "; the errors leave out the first " << run.skip_s << " s.</p>\n";
  if (!draw) return html.str();
  for (GnuplotPicture& picture : benchmarkPictures(run)) {
    picture.name = run.sequence + "_" + shortName(run.drive) + "_" + picture.name;
    try {
      drawPicture(picture, plots);
      html << embedded(picture, plots);
    } catch (const Error& error) {
      failure = error.what();
      html << "<p class=\"missing\">This picture could not be drawn: " << htmlEscaped(failure) << ".</p>\n";
    }
  }
  return html.str();
}

}  // namespace

std::string writeBenchmarkReport(const fs::path& folder, const std::vector<BenchmarkRun>& runs,
                                 const BenchmarkText& text) {
  const bool draw = gnuplotFound();
  const fs::path plots = folder / "plots";
  std::error_code error;
  if (draw) fs::create_directory(plots, error);
  if (error) throw Error(plots.string(), "", error.message());

  std::string note = draw ? "" : kNoGnuplot;
  AtomicOutput output(folder / "report.html");
  std::ostream& html = output.stream();
  const RunRecord& record = text.record;
  html << kHead
       << "<h1>Localization benchmark</h1>\n<p>Localization of LiDAR scans in prebuilt maps by variants of the "
       << "Normal Distributions Transform, compared as in Table I of the paper <em>Segmentation-Aware Weighted NDT for "
       << "Real-Time LiDAR Localization on CPU-Only Platforms</em>. Made on " << htmlEscaped(record.date) << " on "
       << htmlEscaped(record.cpu_model) << " with " << record.threads << " of " << record.cores
       << " cores, by</p>\n<pre>" << htmlEscaped(record.command) << "</pre>\n";
  if (!draw) html << "<p class=\"missing\">" << kNoGnuplot << ".</p>\n";
  html << "<h2>Results</h2>\n";
  for (const TextTable& table : text.tables) html << htmlTable(table);
  html << kHowToRead;
  for (const BenchmarkRun& run : runs) {
    std::string failure;
    html << section(run, plots, draw, failure);
    if (!failure.empty()) note = "the report lacks pictures: " + failure;
  }
  html << "</body>\n</html>\n";
  output.commit();
  return note;
}

}  // namespace saw_ndt
