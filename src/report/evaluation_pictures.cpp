#include "report/evaluation_pictures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <utility>

#include "evaluation/statistics.h"
#include "saw_ndt/evaluation/metrics.h"

namespace saw_ndt {

using namespace internal;

namespace {

using Columns = std::vector<std::vector<double>>;

constexpr int kWidth_px = 1000, kPanel_px = 300, kTitle_px = 66, kAxis_px = 62;
constexpr std::size_t kManyPoses = 20000;
constexpr char kStyle[] =
    "set tics out nomirror\nset border 3 lc rgb '#555555'\nset grid lt 1 lw 0.6 lc rgb '#e3e3e3'\n";
constexpr char kReferenceColour[] = "#888888", kErrorColour[] = "#0072B2", kSecondColour[] = "#D55E00";

std::string rounded(double value) {
  std::ostringstream text;
  text.precision(3);
  text << value;
  return text.str();
}

/// Seconds from the first pair to each.
std::vector<double> timesOf(const std::vector<PosePair>& pairs) {
  std::vector<double> times_s;
  for (const PosePair& pair : pairs) times_s.push_back(pair.stamp_s - pairs.front().stamp_s);
  return times_s;
}

/// Columns that begin with the time, with a line of no numbers, which breaks a curve, where poses are missing.
Columns withBreaks(const Columns& columns) {
  constexpr double kUsualSteps = 5.0;
  const std::vector<double>& times_s = columns.front();
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < times_s.size(); ++i) steps_s.push_back(times_s[i] - times_s[i - 1]);
  const double longest_s = steps_s.empty() ? 0.0 : kUsualSteps * median(steps_s);
  Columns broken(columns.size());
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    const bool is_after_gap = i > 0 && steps_s[i - 1] > longest_s;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (is_after_gap) broken[c].push_back(std::numeric_limits<double>::quiet_NaN());
      broken[c].push_back(columns[c][i]);
    }
  }
  return broken;
}

std::string alignmentText(const TrajectoryEvaluation& evaluation) {
  return evaluation.alignment == TrajectoryAlignment::NONE ? "not aligned"
                                                           : "aligned by " + toString(evaluation.alignment);
}

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// As wide as `share` of `other_m`, and 1 m, at least, with a margin.
  Range shown(double other_m, double share) const {
    const double half_m = 0.53 * std::max({high - low, share * other_m, 1.0}), middle = 0.5 * (low + high);
    return {middle - half_m, middle + half_m};
  }
  double length() const { return high - low; }
};

/// Reference and estimate from above.
GnuplotPicture trajectoryPicture(const TrajectoryEvaluation& evaluation, const std::vector<double>& errors_m) {
  constexpr double kMostWidth_px = 800.0, kMostHeight_px = 800.0, kNarrowest = 0.3;
  constexpr double kLeft_px = 100.0, kRight_px = 130.0;
  const std::vector<PosePair>& pairs = evaluation.paired.pairs;
  Columns columns(6);
  columns[0] = timesOf(pairs);
  columns[5] = errors_m;
  Range x, y;
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d r = pair.T_map_reference.translation(), e = pair.T_map_estimate.translation();
    const double values[] = {r.x(), r.y(), e.x(), e.y()};
    for (std::size_t i = 0; i < 4; ++i) {
      columns[i + 1].push_back(values[i]);
      (i % 2 == 0 ? x : y).add(values[i]);
    }
  }
  const double width_m = x.length(), height_m = y.length();
  x = x.shown(height_m, kNarrowest);
  y = y.shown(width_m, kNarrowest);
  const double px_per_m = std::min(kMostWidth_px / x.length(), kMostHeight_px / y.length());
  GnuplotPicture picture;
  picture.name = "trajectories";
  picture.width_px = static_cast<int>(std::max(px_per_m * x.length(), 400.0) + kLeft_px + kRight_px);
  picture.height_px = static_cast<int>(px_per_m * y.length()) + kTitle_px + kAxis_px;
  const auto [least_m, greatest_m] = std::minmax_element(errors_m.begin(), errors_m.end());
  picture.data =
      gnuplotData("$poses", withBreaks(columns)) + gnuplotData("$start", {{columns[1].front()}, {columns[2].front()}});
  std::ostringstream draw;
  draw.precision(12);
  draw << kStyle << "set size ratio -1\nset xrange [" << x.low << ':' << x.high << "]\nset yrange [" << y.low << ':'
       << y.high << "]\nset lmargin at screen " << kLeft_px / picture.width_px << "\nset rmargin at screen "
       << 1.0 - kRight_px / picture.width_px << "\nset bmargin at screen "
       << static_cast<double>(kAxis_px) / picture.height_px << "\nset tmargin at screen "
       << 1.0 - static_cast<double>(kTitle_px) / picture.height_px
       << "\nset format '%.10g'\nset xtics autofreq\nset xlabel 'x (m)'\nset ylabel 'y (m)'\n"
       << "set title " << gnuplotQuoted("trajectories from above, " + alignmentText(evaluation)) << " offset 0,1.2\n"
       << "set key at graph 0.0,1.01 left bottom horizontal Left reverse\n"
       << "set palette defined (0 '#440154', 1 '#3b528b', 2 '#21918c', 3 '#5ec962', 4 '#fde725')\n"
       << "set cbrange [" << *least_m << ':' << std::max(*greatest_m, *least_m + 1e-9)
       << "]\nset colorbox user origin graph 1.02,graph 0 size 0.018,graph 1\n"
       << "set format cb '%.3g'\nset cblabel 'position error (m)'\n"
       << "plot $poses using 2:3 with lines lw 5 lc rgb '" << kReferenceColour << "' title 'reference', "
       << "$poses using 4:5:6 with lines lw 2 lc palette notitle, "
       << "keyentry with lines lw 2 lc rgb '#21918c' title 'estimate, coloured by its error', "
       << "$start using 1:2 with points pt 6 ps 1.6 lw 2 lc rgb '#000000' title 'start'\n";
  picture.commands = draw.str();
  picture.caption = "The paired poses; the estimate has the colour of its position error.";
  return picture;
}

/// One figure over time, with lines across.
struct TimeChart {
  std::string axis;
  std::vector<double> values;
  std::vector<std::pair<std::string, double>> lines;  ///< name with its value, and height
  bool has_signs = false;
};

/// Panels below each other over the same times.
GnuplotPicture timePicture(const std::string& name, const std::string& title, const std::vector<double>& times_s,
                           const std::vector<TimeChart>& charts, const std::string& time_axis) {
  const int count = static_cast<int>(charts.size());
  GnuplotPicture picture;
  picture.name = name;
  picture.width_px = kWidth_px;
  picture.height_px = kTitle_px + (kPanel_px + kAxis_px) * count;
  Columns columns{times_s};
  for (const TimeChart& chart : charts) columns.push_back(chart.values);
  picture.data = gnuplotData("$errors", withBreaks(columns));
  std::ostringstream draw;
  draw.precision(12);
  const double height_px = picture.height_px;
  const double margin_s = std::max(0.01 * (times_s.back() - times_s.front()), 1e-3);
  draw << kStyle << "set xrange [" << times_s.front() - margin_s << ':' << times_s.back() + margin_s
       << "]\nset lmargin at screen 0.1\nset rmargin at screen 0.97\nset key at graph 1.0,1.02 right bottom "
          "horizontal Left reverse\n"
       << "set multiplot title " << gnuplotQuoted(title) << '\n';
  const std::string style = times_s.size() < 250 ? "with linespoints pt 7 ps 0.4 lw 1.5" : "with lines lw 0.9";
  for (int i = 0; i < count; ++i) {
    const TimeChart& chart = charts[static_cast<std::size_t>(i)];
    if (i + 1 == count) draw << "set xlabel " << gnuplotQuoted(time_axis) << '\n';
    const double bottom_px = kAxis_px + (kPanel_px + kAxis_px) * (count - 1 - i);
    draw << "set bmargin at screen " << bottom_px / height_px << "\nset tmargin at screen "
         << (bottom_px + kPanel_px) / height_px << "\nset yrange [" << (chart.has_signs ? "*" : "0")
         << ":*]\nset ylabel " << gnuplotQuoted(chart.axis) << "\nplot $errors using 1:" << i + 2 << ' ' << style
         << " lc rgb '" << kErrorColour << "' notitle";
    int dash = 2;
    for (const auto& [text, height] : chart.lines) {
      draw << ", " << height << " with lines lw 1.8 dashtype " << dash << " lc rgb '"
           << (dash == 2 ? kSecondColour : "#000000") << "' title " << gnuplotQuoted(text);
      dash = 3;
    }
    draw << '\n';
  }
  draw << "unset multiplot\n";
  picture.commands = draw.str();
  return picture;
}

TimeChart errorChart(const std::string& axis, const std::string& unit, std::vector<double> values) {
  const ErrorStatistics statistics = errorStatistics(values);
  return {axis + " (" + unit + ")",
          std::move(values),
          {{"rmse " + rounded(statistics.rmse) + ' ' + unit, statistics.rmse},
           {"mean " + rounded(statistics.mean) + ' ' + unit, statistics.mean}},
          false};
}

GnuplotPicture relativePicture(const TrajectoryEvaluation& evaluation, const RelativeEvaluation& relative,
                               const std::string& unit) {
  const std::vector<double> all_times_s = timesOf(evaluation.paired.pairs);
  std::vector<double> times_s, translations_m, rotations_deg;
  for (const RelativePoseError& error : relative.errors) {
    times_s.push_back(all_times_s[error.last]);
    translations_m.push_back(error.translation_m);
    rotations_deg.push_back(error.rotation_deg);
  }
  const std::string title = "relative errors over " + rounded(relative.options.delta) + ' ' +
                            (unit == "frames" ? "frames" : "m") +
                            (relative.options.all_pairs ? ", from every pose" : ", one after the other");
  return timePicture("relative_error_" + unit, title, times_s,
                     {errorChart("translation error", "m", std::move(translations_m)),
                      errorChart("rotation error", "deg", std::move(rotations_deg))},
                     "time of the later pose since the first pair (s)");
}

}  // namespace

std::vector<GnuplotPicture> evaluationPictures(const TrajectoryEvaluation& evaluation) {
  const std::vector<PosePair>& pairs = evaluation.paired.pairs;
  std::vector<double> errors_m, yaws_deg, absolute_yaws_deg;
  for (const PosePair& pair : pairs) {
    errors_m.push_back(poseError(pair.T_map_reference, pair.T_map_estimate).position_m);
    yaws_deg.push_back(degreesFromRadians(wrappedAngle(heading(pair.T_map_estimate) - heading(pair.T_map_reference))));
    absolute_yaws_deg.push_back(std::abs(yaws_deg.back()));
  }
  const std::string time_axis = "time since the first pair (s)", aligned = ", " + alignmentText(evaluation);
  const TimeChart yaw{"yaw error (deg)",
                      yaws_deg,
                      {{"mean " + rounded(mean(yaws_deg)) + " deg (of the absolute errors " +
                            rounded(mean(absolute_yaws_deg)) + " deg)",
                        mean(yaws_deg)}},
                      true};
  std::vector<GnuplotPicture> pictures{
      trajectoryPicture(evaluation, errors_m),
      timePicture("position_error", "position error" + aligned, timesOf(pairs),
                  {errorChart("position error", "m", errors_m)}, time_axis),
      timePicture("yaw_error", "yaw error" + aligned, timesOf(pairs), {yaw}, time_axis)};
  if (evaluation.by_frames) pictures.push_back(relativePicture(evaluation, *evaluation.by_frames, "frames"));
  if (evaluation.by_metres) pictures.push_back(relativePicture(evaluation, *evaluation.by_metres, "metres"));
  for (GnuplotPicture& picture : pictures) picture.many_points = pairs.size() > kManyPoses;
  return pictures;
}

}  // namespace saw_ndt
