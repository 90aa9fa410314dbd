#include "segmentation/ring_index.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "common/middle_value.h"
#include "common/rows_and_columns.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt::internal {
namespace {

// Mean misfit of runs and beams above which a scan is not listed ring after ring: on KITTI it is below 0.6 degrees, and
// above 5 where the points come in another order.
constexpr float kGreatestMeanMisfitDeg = 1.5F;

// How far beyond the outermost beams a point may lie, since calibration and motion compensation shift what is seen.
constexpr double kElevationMarginDeg = 1.5;

constexpr std::size_t kSamplesOfRun = 32;
constexpr std::size_t kSamplesOfScan = 2048;
constexpr double kMostRings = 1024.0;

[[noreturn]] void refuseRing(double ring, std::size_t point, const SensorModel& sensor) {
  std::ostringstream message;
  message << "ring " << ring << " of point " << point << ": sensor model " << sensor.name << " has " << sensor.rows()
          << " rows";
  throw std::invalid_argument(message.str());
}

}  // namespace

void RingIndex::assign(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor) {
  const auto rows = static_cast<std::size_t>(sensor.rows());
  const bool is_organized = isOrganized(scan);
  runs_.clear();
  if (is_organized && scan.height == rows) {
    source_ = VerticalIndexSource::ORGANIZED_ROW;
    const auto row_of = [&](std::size_t point) { return point / scan.width; };
    orderGroups(scan, points, rows, row_of, sensor);
    for (std::size_t row = 0; row < rows; ++row) {
      runs_.push_back({row * scan.width, (row + 1) * scan.width, row_of_group_[row]});
    }
  } else if (is_organized && scan.width == rows) {
    source_ = VerticalIndexSource::ORGANIZED_COLUMN;
    const auto row_of = [&](std::size_t point) { return point % scan.width; };
    orderGroups(scan, points, rows, row_of, sensor);
    rows_.resize(scan.size);
    for (std::size_t i = 0; i < scan.size; ++i) rows_[i] = row_of_group_[row_of(i)];
  } else if (scan.rings.known() && assignFromRings(scan, points, sensor)) {
    source_ = VerticalIndexSource::RING_FIELD;
  } else if (findRuns(scan, points, sensor.columns, rows, runs_) && matchRunsToBeams(scan, points, sensor)) {
    source_ = VerticalIndexSource::FILE_ORDER;
  } else {
    source_ = VerticalIndexSource::ELEVATION_TABLE;
    assignFromElevation(scan, points, sensor);
  }
}

bool RingIndex::assignFromRings(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor) {
  rows_.resize(scan.size);
  std::size_t groups = static_cast<std::size_t>(sensor.rows());
  for (std::size_t i = 0; i < scan.size; ++i) {
    const double ring = scan.rings[i];
    if (!(ring >= 0.0 && ring < kMostRings)) refuseRing(ring, i, sensor);
    rows_[i] = static_cast<std::int16_t>(ring);
    groups = std::max(groups, static_cast<std::size_t>(rows_[i]) + 1);
  }
  orderGroups(
      scan, points, groups, [&](std::size_t point) { return static_cast<std::size_t>(rows_[point]); }, sensor);
  if (!groupsAreBeams()) return false;
  for (std::size_t i = 0; i < scan.size; ++i) {
    const std::int16_t row = row_of_group_[static_cast<std::size_t>(rows_[i])];
    if (row == kNoRow) refuseRing(scan.rings[i], i, sensor);
    rows_[i] = row;
  }
  return true;
}

// Numbers that are none of beams, such as a counter, have all elevations in each group, or, where the counter goes
// round about as often as the sensor fires, many.
bool RingIndex::groupsAreBeams() const {
  // Of the variance of all elevations that may be left within the groups: of real rings it is below 0.14, that much
  // where motion has been taken out of a scan; of a counter modulo the number of beams it is 0.69 and more.
  constexpr double kGreatestShare = 0.3;
  constexpr std::size_t kLeastPoints = 200;
  double points = 0.0, sum = 0.0, squares = 0.0, within = 0.0;
  for (const GroupSum& group : group_sums_) {
    if (group.points == 0) continue;
    points += group.points;
    sum += group.sine;
    squares += group.squared_sine;
    within += group.squared_sine - group.sine * group.sine / static_cast<float>(group.points);
  }
  return points < kLeastPoints || within <= kGreatestShare * (squares - sum * sum / points);
}

// Groups are numbered from the top, from the bottom, or in some other order, as the lasers of a Velodyne are.
template <typename GroupOfPoint>
void RingIndex::orderGroups(const ScanView& scan, const PointMeasurements& points, std::size_t groups,
                            const GroupOfPoint& group_of_point, const SensorModel& sensor) {
  // A prime, so that a scan in firing order has samples of every beam.
  constexpr std::size_t kSampleStep = 7;
  group_sums_.assign(groups, {});
  for (std::size_t i = 0; i<scan.size; i += scan.size> kSamplesOfScan ? kSampleStep : 1) {
    if (points.range[i] <= 0.0F) continue;
    GroupSum& sum = group_sums_[group_of_point(i)];
    const float sine = points.elevationSine(scan, i);
    sum.sine += sine;
    sum.squared_sine += sine * sine;
    ++sum.points;
  }
  group_order_.clear();
  const auto rows = static_cast<std::size_t>(sensor.rows());
  float falling_misfit = 0.0F, rising_misfit = 0.0F;  // of rows that fall as group numbers rise, from the top, and back
  for (std::size_t group = 0; group < groups; ++group) {
    GroupSum& sum = group_sums_[group];
    if (sum.points == 0) continue;
    const float sine = sum.sine / static_cast<float>(sum.points);
    sum.elevation_deg = static_cast<float>(degreesFromRadians(std::asin(std::clamp(sine, -1.0F, 1.0F))));
    group_order_.push_back(group);
    if (group >= rows) continue;
    falling_misfit += std::abs(sum.elevation_deg - static_cast<float>(sensor.elevations_deg[group]));
    rising_misfit += std::abs(sum.elevation_deg - static_cast<float>(sensor.elevations_deg[rows - 1 - group]));
  }
  row_of_group_.assign(groups, kNoRow);
  const bool falls = falling_misfit <= rising_misfit;
  const auto by_number = [&] {
    for (std::size_t group = 0; group < std::min(groups, rows); ++group) {
      row_of_group_[group] = static_cast<std::int16_t>(falls ? group : rows - 1 - group);
    }
  };
  const float misfit = std::min(falling_misfit, rising_misfit) / static_cast<float>(group_order_.size());
  const double spacing = (sensor.elevations_deg.front() - sensor.elevations_deg.back()) /
                         static_cast<double>(std::max<std::size_t>(1, rows - 1));
  if (groups == rows && (group_order_.empty() || misfit <= 0.5 * spacing)) return by_number();

  std::sort(group_order_.begin(), group_order_.end(), [&](std::size_t a, std::size_t b) {
    return std::make_pair(-group_sums_[a].elevation_deg, a) < std::make_pair(-group_sums_[b].elevation_deg, b);
  });
  run_elevations_.clear();
  for (const std::size_t group : group_order_) run_elevations_.push_back(group_sums_[group].elevation_deg);
  // An order that is not much better is chance: then the beams are not those of the sensor.
  constexpr float kClearlyBetter = 0.5F;
  const float sorted_misfit = beams_.match(run_elevations_, {}, sensor);
  if (groups == rows && !(sorted_misfit < kClearlyBetter * misfit)) return by_number();
  if (std::isinf(sorted_misfit)) return by_number();
  std::vector<std::uint8_t>& taken = row_is_taken_;
  taken.assign(rows, 0);
  for (std::size_t i = 0; i < group_order_.size(); ++i) {
    row_of_group_[group_order_[i]] = beams_.rows()[i];
    taken[static_cast<std::size_t>(beams_.rows()[i])] = 1;
  }
  // Groups that were not sampled have the rows that are left.
  std::size_t free_row = 0;
  for (std::int16_t& row : row_of_group_) {
    if (row != kNoRow) continue;
    while (free_row < rows && taken[free_row] != 0) ++free_row;
    if (free_row == rows) break;
    row = static_cast<std::int16_t>(free_row++);
  }
}

bool RingIndex::matchRunsToBeams(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor) {
  const std::size_t runs = runs_.size();
  run_elevations_.resize(runs);
  run_spreads_.resize(runs);
  std::size_t points_spread = 0;
  for (std::size_t run = 0; run < runs; ++run) {
    const std::size_t end = runs_[run].end;
    const std::size_t step = std::max<std::size_t>(1, (end - runs_[run].begin) / kSamplesOfRun);
    samples_.clear();
    samples_.reserve(2 * kSamplesOfRun);
    // A run of more points than a ring has may be a scan in firing order. Samples at even distances would then all be
    // of one beam where the distance is a multiple of the number of beams.
    constexpr std::size_t kPrime = 7919;
    const bool is_long = end - runs_[run].begin > 2 * static_cast<std::size_t>(sensor.columns);
    for (std::size_t k = 0; runs_[run].begin + k * step < end; ++k) {
      const std::size_t i = std::min(end - 1, runs_[run].begin + k * step + (is_long ? k * kPrime % step : 0));
      if (points.range[i] > 0.0F) samples_.push_back(points.elevationSine(scan, i));
    }
    if (samples_.empty()) samples_.push_back(0.0F);
    const float median = middleValue(samples_);
    for (float& sample : samples_) sample = std::abs(sample - median);
    run_elevations_[run] = static_cast<float>(degreesFromRadians(std::asin(std::clamp(median, -1.0F, 1.0F))));
    run_spreads_[run] = static_cast<float>(degreesFromRadians(middleValue(samples_)));
    if (run_spreads_[run] > kGreatestSpreadOfRunDeg) points_spread += end - runs_[run].begin;
  }
  if (static_cast<double>(points_spread) > kMostPointsInSpreadRuns * static_cast<double>(scan.size)) return false;

  const bool rises = run_elevations_.front() < run_elevations_.back();
  if (rises) {
    std::reverse(run_elevations_.begin(), run_elevations_.end());
    std::reverse(run_spreads_.begin(), run_spreads_.end());
  }
  if (!(beams_.match(run_elevations_, run_spreads_, sensor) <= kGreatestMeanMisfitDeg)) return false;
  for (std::size_t run = 0; run < runs; ++run) runs_[rises ? runs - 1 - run : run].row = beams_.rows()[run];
  return true;
}

void RingIndex::assignFromElevation(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor) {
  const std::vector<double>& beams = sensor.elevations_deg;
  const auto sine = [](double elevation_deg) {
    return static_cast<float>(std::sin(radiansFromDegrees(elevation_deg)));
  };
  beam_sines_.clear();
  for (std::size_t row = 0; row + 1 < beams.size(); ++row)
    beam_sines_.push_back(sine((beams[row] + beams[row + 1]) / 2));
  const float greatest = sine(std::min(90.0, beams.front() + kElevationMarginDeg));
  const float least = sine(std::max(-90.0, beams.back() - kElevationMarginDeg));
  rows_.resize(scan.size);
  for (std::size_t i = 0; i < scan.size; ++i) {
    rows_[i] = kNoRow;
    if (points.range[i] <= 0.0F) continue;
    const float point_sine = points.elevationSine(scan, i);
    if (point_sine > greatest || point_sine < least) continue;
    const auto below = std::upper_bound(beam_sines_.begin(), beam_sines_.end(), point_sine, std::greater<float>());
    rows_[i] = static_cast<std::int16_t>(below - beam_sines_.begin());
  }
}

}  // namespace saw_ndt::internal
