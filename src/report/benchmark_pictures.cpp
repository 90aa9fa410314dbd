#include "report/benchmark_pictures.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "evaluation/statistics.h"
#include "report/map_picture.h"
#include "report/method_colour.h"
#include "report/scan_errors.h"

namespace saw_ndt {

using namespace internal;

namespace {

constexpr int kWidth_px = 1000, kPanel_px = 112, kTitle_px = 45, kAxis_px = 62;
constexpr double kScanPeriod_ms = 100.0;

constexpr char kChartStyle[] =
    "set tics out nomirror\nset border 3 lc rgb '#555555'\nset grid lt 1 lw 0.6 lc rgb '#e3e3e3'\n";

constexpr double kHeadroom = 0.12;       // share of a panel above its data, for the marks of rejected scans
constexpr std::size_t kManyScans = 250;  // from here on dots would hide more than they show

/// One figure of every scan, for each method, along the way.
struct WayChart {
  std::string name;
  std::string title;
  std::string axis;
  std::vector<std::vector<double>> values;  ///< a series a method
  std::vector<std::string> notes;           ///< a word on each method
  double limit = std::nan("");              ///< a line across; NaN for none
  bool may_be_logarithmic = true;
  std::string caption;
};

std::string fixed(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

/// 1, 2 or 5 times a power of ten, such that about three steps fill the range.
double stepFor(double range) {
  const double power = std::pow(10.0, std::floor(std::log10(range / 3.0)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= range / 3.0) return factor * power;
  }
  return 10.0 * power;
}

/// The range of the values and whether their axis is logarithmic: where few are much greater than the rest.
struct ValueAxis {
  bool logarithmic = false;
  double low = 0.0, high = 1.0;

  ValueAxis(const WayChart& chart) {
    std::vector<double> all;
    for (const std::vector<double>& series : chart.values) all.insert(all.end(), series.begin(), series.end());
    high = *std::max_element(all.begin(), all.end());
    if (std::isfinite(chart.limit)) high = std::max(high, chart.limit);
    logarithmic = chart.may_be_logarithmic && high > 20.0 * median(all) && median(all) > 0.0;
    if (logarithmic) low = std::max(percentile(all, 1.0), high * 1e-5);
    high = high > 0.0 ? high : 1.0;
    high = at(1.0 + kHeadroom);
  }

  /// The value at a share of the axis' length.
  double at(double share) const { return logarithmic ? low * std::pow(high / low, share) : low + share * (high - low); }
};

std::string commandsOf(const ValueAxis& axis) {
  std::ostringstream text;
  text << "set yrange [" << axis.low << ':' << axis.high << "]\n";
  if (axis.logarithmic) {
    text << "set logscale y\nset ytics 10\n";
  } else {
    text << "set ytics " << stepFor(axis.high) << '\n';
  }
  return text.str();
}

/// Panels below each other, one a method: its values in its colour, those of the others in grey behind them.
GnuplotPicture wayPicture(const BenchmarkRun& run, const WayChart& chart) {
  const std::size_t count = run.cells.size();
  const std::vector<double> distances_m = distancesDriven(run);
  const ValueAxis axis(chart);
  GnuplotPicture picture;
  picture.name = chart.name;
  picture.width_px = kWidth_px;
  picture.height_px = kTitle_px + kAxis_px + kPanel_px * static_cast<int>(count);
  std::ostringstream draw;
  draw << kChartStyle << commandsOf(axis) << "set xrange [0:" << std::max(distances_m.back(), 1e-3) << "]\n"
       << "unset key\nset format x ''\n"
       << "set multiplot layout " << count << ",1 title " << gnuplotQuoted(chart.title) << " margins 0.085,0.83,"
       << static_cast<double>(kAxis_px) / picture.height_px << ','
       << 1.0 - static_cast<double>(kTitle_px) / picture.height_px << " spacing 0," << 20.0 / picture.height_px << '\n';
  const double skipped_m = distanceSkipped(run);
  if (skipped_m > 0.0) {
    draw << "set object 1 rectangle from 0,graph 0 to " << skipped_m
         << ",graph 1 behind fillstyle solid 1 noborder fillcolor rgb '#f0f0f0'\n";
  }
  if (std::isfinite(chart.limit)) {
    draw << "set arrow 1 from graph 0,first " << chart.limit << " to graph 1,first " << chart.limit
         << " nohead dashtype 2 lw 1.2 lc rgb '#000000'\n";
  }
  const double mark_y = axis.at(0.93);
  const std::string line =
      distances_m.size() < kManyScans ? "with linespoints pt 7 ps 0.25 lw 1.8" : "with lines lw 1.1";
  for (std::size_t m = 0; m < count; ++m) {
    const BenchmarkCell& cell = run.cells[m];
    std::vector<double> mark;
    for (const LocalizationResult& result : cell.run.results) mark.push_back(result.accepted() ? std::nan("") : mark_y);
    std::vector<double> shown = chart.values[m];
    for (double& value : shown) value = std::max(value, axis.low);
    picture.data += gnuplotData("$method" + std::to_string(m), {distances_m, shown, mark});

    if (m == 0) draw << "set label 1 " << gnuplotQuoted(chart.axis) << " at screen 0.018,0.5 rotate center\n";
    if (m == 1) draw << "unset label 1\n";
    if (m + 1 == count) draw << "set format x '%g'\nset xlabel 'distance driven (m)'\n";
    draw << "set label 2 " << gnuplotQuoted(cell.method) << " at graph 1.015,0.62 left textcolor rgb '"
         << methodColour(cell.method) << "' font ',12'\nset label 3 " << gnuplotQuoted(chart.notes[m])
         << " at graph 1.015,0.36 left textcolor rgb '#444444' font ',9'\nplot ";
    for (std::size_t other = 0; other < count; ++other) {
      if (other != m) draw << "$method" << other << " using 1:2 with lines lw 1 lc rgb '#cfcfcf', ";
    }
    draw << "$method" << m << " using 1:2 " << line << " lc rgb '" << methodColour(cell.method) << "', $method" << m
         << " using 1:3:(0):(" << axis.high - mark_y << ") with vectors nohead lw 1.2 lc rgb '#000000'\n";
  }
  draw << "unset multiplot\n";
  picture.commands = draw.str();
  std::string caption = chart.caption +
                        " In each panel one method has its colour and the others are grey; black ticks at its top are "
                        "scans that it rejected.";
  if (axis.logarithmic) caption += " The axis is logarithmic.";
  if (skipped_m > 0.0) caption += " The shaded start is left out of the errors of the tables.";
  picture.caption = caption;
  return picture;
}

/// A row a method: a dot a scan, a box from the 25th to the 75th percentile with the median in it, whiskers from the
/// 5th to the 95th.
GnuplotPicture timePicture(const BenchmarkRun& run) {
  constexpr int kRow_px = 62;
  const std::size_t count = run.cells.size();
  GnuplotPicture picture;
  picture.name = "run_time";
  picture.width_px = kWidth_px;
  picture.height_px = kTitle_px + 20 + kAxis_px + kRow_px * static_cast<int>(count);
  double least_ms = kScanPeriod_ms, most_ms = kScanPeriod_ms;
  std::ostringstream draw, plots;
  draw << std::setprecision(9) << kChartStyle;
  for (std::size_t m = 0; m < count; ++m) {
    const BenchmarkCell& cell = run.cells[m];
    const double y = static_cast<double>(count - m);
    const std::string colour = "lc rgb '" + methodColour(cell.method) + "'";
    std::vector<double> times_ms, heights;
    for (const LocalizationResult& result : cell.run.results) {
      times_ms.push_back(result.times.total_ms);
      heights.push_back(y + 0.045 * (static_cast<double>(heights.size() * 7 % 11) - 5.0));
    }
    least_ms = std::min(least_ms, percentile(times_ms, 0.0));
    most_ms = std::max(most_ms, percentile(times_ms, 100.0));
    const std::string block = "$method" + std::to_string(m);
    picture.data += gnuplotData(block, {times_ms, heights});
    plots << (m == 0 ? "plot " : ", ") << block << " with points pt 7 ps "
          << (times_ms.size() < kManyScans ? 0.45 : 0.25) << ' ' << colour;
    const auto line = [&](double from_percent, double from_y, double to_percent, double to_y, double width) {
      draw << "set arrow from " << percentile(times_ms, from_percent) << ',' << from_y << " to "
           << percentile(times_ms, to_percent) << ',' << to_y << " nohead front lw " << width << " lc rgb '#000000'\n";
    };
    draw << "set object rectangle from " << percentile(times_ms, 25) << ',' << y - 0.33 << " to "
         << percentile(times_ms, 75) << ',' << y + 0.33 << " front fillstyle empty border lc rgb '#000000' lw 1.2\n";
    line(5, y, 25, y, 1.2);
    line(75, y, 95, y, 1.2);
    line(5, y - 0.15, 5, y + 0.15, 1.2);
    line(95, y - 0.15, 95, y + 0.15, 1.2);
    line(50, y - 0.33, 50, y + 0.33, 3.0);
    draw << "set label " << gnuplotQuoted(cell.method) << " at graph -0.012,first " << y << " right textcolor rgb '"
         << methodColour(cell.method) << "' font ',12'\nset label "
         << gnuplotQuoted("mean " + fixed(cell.summary.total_ms.mean, 1) + ", P95 " +
                          fixed(cell.summary.total_ms.p95, 1) + " ms")
         << " at graph 1.015,first " << y << " left textcolor rgb '#444444' font ',9'\n";
  }
  const bool logarithmic = least_ms > 0.0 && most_ms > 8.0 * least_ms;
  draw << (logarithmic ? "set logscale x\nset xtics (5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000, 20000)\n"
                       : "")
       << "set xrange [" << (logarithmic ? least_ms / 1.2 : 0.0) << ':' << most_ms * (logarithmic ? 1.2 : 1.05)
       << "]\nset yrange [0.45:" << static_cast<double>(count) + 0.55
       << "]\nunset ytics\nset border 1\nunset key\nset lmargin at screen 0.16\nset rmargin at screen 0.81\n"
       << "set xlabel 'time from the scan in memory to the pose (ms)'\nset title "
       << gnuplotQuoted(run.sequence + ", " + toString(run.drive) + ": run times") << " offset 0,0.8\n"
       << "set arrow from first " << kScanPeriod_ms << ",graph 0 to first " << kScanPeriod_ms
       << ",graph 1 nohead dashtype 2 lw 1.2 lc rgb '#555555'\nset label '100 ms' at first " << kScanPeriod_ms
       << ",graph 1.035 center textcolor rgb '#555555' font ',9'\n"
       << plots.str() << '\n';
  picture.commands = draw.str();
  picture.caption = std::string(
                        "A dot a scan; the box holds the middle half of them with the median in it, its lines end "
                        "at the 5th and 95th percentile. The dashed line at 100 ms is one turn of a LiDAR at "
                        "10 Hz.") +
                    (logarithmic ? " The axis is logarithmic." : "");
  return picture;
}

}  // namespace

std::vector<GnuplotPicture> benchmarkPictures(const BenchmarkRun& run) {
  const std::string where = run.sequence + ", " + toString(run.drive) + ": ";
  WayChart position{"position_error",
                    where + "position error along the way",
                    "position error (m)",
                    {},
                    {},
                    std::nan(""),
                    true,
                    "Distance of each pose from the reference."};
  WayChart yaw{"yaw_error",
               where + "yaw error along the way",
               "yaw error (deg)",
               {},
               {},
               std::nan(""),
               true,
               "Difference of each heading from that of the reference."};
  WayChart likelihood{"likelihood",
                      where + "likelihood along the way",
                      "likelihood",
                      {},
                      {},
                      run.min_likelihood,
                      false,
                      "How well the scan fits the map at the pose found, in a figure that weights do not change; a "
                      "method of this project rejects a scan below the dashed line."};
  for (const BenchmarkCell& cell : run.cells) {
    const ScanErrors errors = scanErrors(run, cell);
    position.values.push_back(errors.position_error_m);
    yaw.values.push_back(errors.yaw_error_deg);
    std::vector<double>& values = likelihood.values.emplace_back();
    for (const LocalizationResult& result : cell.run.results) values.push_back(result.alignment.likelihoods.unweighted);
    position.notes.push_back("ATE " + fixed(cell.summary.metrics->ate_rmse_m, 4) + " m");
    yaw.notes.push_back("mean " + fixed(cell.summary.metrics->yaw_mae_deg, 4) + " deg");
    likelihood.notes.push_back(std::to_string(cell.summary.rejected) + " of " + std::to_string(cell.summary.scans) +
                               " rejected");
  }
  return {mapPicture(run), wayPicture(run, position), wayPicture(run, yaw), wayPicture(run, likelihood),
          timePicture(run)};
}

}  // namespace saw_ndt
