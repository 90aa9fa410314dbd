#include "saw_ndt/segmentation/ring_index.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "saw_ndt/common/geometry.h"

namespace saw_ndt {
namespace {

// A smaller fall is a point that parallax or motion compensation put behind its predecessor (10 degrees on KITTI).
constexpr double kAzimuthFallOfNextRingDeg = 200.0;

// Mean misfit of runs and beams above which a scan is not listed ring after ring: on KITTI it is below 0.6 degrees, and
// above 5 where the points come in another order.
constexpr float kGreatestMeanMisfitDeg = 1.5F;

// How far beyond the outermost beams a point may lie, since calibration and motion compensation shift what is seen.
constexpr double kElevationMarginDeg = 1.5;

constexpr std::size_t kSamplesOfRun = 32;
constexpr std::size_t kSamplesOfScan = 2048;

float elevationSine(const ScanView& scan, const PointMeasurements& points, std::size_t index) {
  return scan.point(index)[2] / points.range[index];
}

float medianOf(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Where the next ring begins, if the azimuth falls at a point with y = 0. That is rounded from just before or just
// after a whole turn: the point ends the ring above or begins the one below, whichever beam it fits. scan.size: no ring
// begins.
std::size_t ringStartAtSeam(const ScanView& scan, const PointMeasurements& points, std::size_t seam) {
  std::size_t before = seam - 1;
  while (points.range[before] <= 0.0F) --before;
  std::size_t after = seam + 1;
  while (after < scan.size && points.range[after] <= 0.0F) ++after;
  if (after == scan.size) return scan.size;
  const float sine = elevationSine(scan, points, seam);
  const float to_ring_above = std::abs(sine - elevationSine(scan, points, before));
  const float to_ring_below = std::abs(sine - elevationSine(scan, points, after));
  return to_ring_above < to_ring_below ? after : seam;
}

bool isOrganized(const ScanView& scan, int rows) {
  return scan.height > 1 && scan.height == static_cast<std::size_t>(rows) && scan.width * scan.height == scan.size;
}

}  // namespace

void RingIndex::assign(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor) {
  rows_.resize(scan.size);
  if (isOrganized(scan, sensor.rows())) {
    source_ = VerticalIndexSource::OrganizedRow;
    for (std::size_t i = 0; i < scan.size; ++i) rows_[i] = static_cast<std::int16_t>(i / scan.width);
    putLowestRowLast(scan, points, sensor);
  } else if (scan.rings != nullptr) {
    source_ = VerticalIndexSource::RingField;
    for (std::size_t i = 0; i < scan.size; ++i) {
      if (scan.rings[i] >= sensor.rows()) {
        throw std::invalid_argument("ring " + std::to_string(scan.rings[i]) + " of point " + std::to_string(i) +
                                    ": sensor model " + sensor.name + " has " + std::to_string(sensor.rows()) +
                                    " rows");
      }
      rows_[i] = static_cast<std::int16_t>(scan.rings[i]);
    }
    putLowestRowLast(scan, points, sensor);
  } else if (assignFromFileOrder(scan, points, sensor)) {
    source_ = VerticalIndexSource::FileOrder;
  } else {
    source_ = VerticalIndexSource::ElevationTable;
    assignFromElevation(scan, points, sensor);
  }
}

bool RingIndex::findRuns(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor) {
  const auto most_runs = static_cast<std::size_t>(sensor.rows());
  const auto fall = static_cast<std::int32_t>(sensor.columns * (kAzimuthFallOfNextRingDeg / 360.0));
  std::int32_t previous_column = -1;
  run_starts_.clear();
  run_starts_.push_back(0);
  for (std::size_t i = 0; i < scan.size; ++i) {
    if (points.range[i] <= 0.0F) continue;
    const bool falls = points.column[i] < previous_column - fall;
    previous_column = points.column[i];
    if (!falls) continue;
    const std::size_t start = scan.point(i)[1] == 0.0F ? ringStartAtSeam(scan, points, i) : i;
    if (start == scan.size) continue;
    if (run_starts_.size() == most_runs) return false;
    run_starts_.push_back(start);
  }
  return true;
}

bool RingIndex::assignFromFileOrder(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor) {
  if (!findRuns(scan, points, sensor)) return false;
  if (!matchRunsToBeams(scan, points, sensor)) return false;

  for (std::size_t run = 0; run < run_starts_.size(); ++run) {
    const std::size_t end = run + 1 < run_starts_.size() ? run_starts_[run + 1] : scan.size;
    std::fill(rows_.begin() + static_cast<std::ptrdiff_t>(run_starts_[run]),
              rows_.begin() + static_cast<std::ptrdiff_t>(end), row_of_run_[run]);
  }
  return true;
}

bool RingIndex::matchRunsToBeams(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor) {
  const std::size_t runs = run_starts_.size();
  const auto rows = static_cast<std::size_t>(sensor.rows());
  run_elevations_.resize(runs);
  run_spreads_.resize(runs);
  for (std::size_t run = 0; run < runs; ++run) {
    const std::size_t start = run_starts_[run];
    const std::size_t end = run + 1 < runs ? run_starts_[run + 1] : scan.size;
    const std::size_t step = std::max<std::size_t>(1, (end - start) / kSamplesOfRun);
    samples_.clear();
    samples_.reserve(2 * kSamplesOfRun);
    for (std::size_t i = start; i < end; i += step) {
      if (points.range[i] > 0.0F) samples_.push_back(elevationSine(scan, points, i));
    }
    if (samples_.empty()) samples_.push_back(0.0F);
    const float median = medianOf(samples_);
    for (float& sample : samples_) sample = std::abs(sample - median);
    run_elevations_[run] = static_cast<float>(degreesFromRadians(std::asin(std::clamp(median, -1.0F, 1.0F))));
    run_spreads_[run] = static_cast<float>(degreesFromRadians(medianOf(samples_)));
  }

  // Rows rise with runs: the cheapest such assignment, by dynamic programming over (run, row).
  const float unreachable = std::numeric_limits<float>::infinity();
  costs_.assign(rows + 1, 0.0F);  // costs_[row]: the cheapest assignment of the runs so far to rows before `row`
  taken_.assign(runs * rows, 0);
  for (std::size_t run = 0; run < runs; ++run) {
    float before = costs_[0];
    costs_[0] = unreachable;
    for (std::size_t row = 0; row < rows; ++row) {
      const auto beam = static_cast<float>(sensor.elevations_deg[row]);
      const float here = before + std::abs(run_elevations_[run] - beam) + run_spreads_[run];
      before = costs_[row + 1];
      taken_[run * rows + row] = here < costs_[row] ? 1 : 0;
      costs_[row + 1] = std::min(here, costs_[row]);
    }
  }
  if (!(costs_[rows] <= kGreatestMeanMisfitDeg * static_cast<float>(runs))) return false;

  row_of_run_.resize(runs);
  std::size_t row = rows;
  for (std::size_t run = runs; run-- > 0;) {
    do {
      --row;
    } while (taken_[run * rows + row] == 0);
    row_of_run_[run] = static_cast<std::int16_t>(row);
  }
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
  for (std::size_t i = 0; i < scan.size; ++i) {
    rows_[i] = kNoRow;
    if (points.range[i] <= 0.0F) continue;
    const float point_sine = elevationSine(scan, points, i);
    if (point_sine > greatest || point_sine < least) continue;
    const auto below = std::upper_bound(beam_sines_.begin(), beam_sines_.end(), point_sine, std::greater<float>());
    rows_[i] = static_cast<std::int16_t>(below - beam_sines_.begin());
  }
}

void RingIndex::putLowestRowLast(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor) {
  const std::size_t step = std::max<std::size_t>(1, scan.size / kSamplesOfScan);
  const double middle_row = 0.5 * (sensor.rows() - 1);
  double rows = 0.0;
  double sines = 0.0;
  double products = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < scan.size; i += step) {
    if (points.range[i] <= 0.0F) continue;
    const double row = rows_[i] - middle_row;
    const double sine = elevationSine(scan, points, i);
    rows += row;
    sines += sine;
    products += row * sine;
    count += 1.0;
  }
  const bool rises = products * count > rows * sines;
  if (!rises) return;
  for (std::int16_t& row : rows_) row = static_cast<std::int16_t>(sensor.rows() - 1 - row);
}

}  // namespace saw_ndt
