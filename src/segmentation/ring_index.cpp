#include "segmentation/ring_index.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "saw_ndt/common/geometry.h"

namespace saw_ndt::internal {
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
  if (isOrganized(scan, sensor.rows())) {
    source_ = VerticalIndexSource::ORGANIZED_ROW;
    runs_.clear();
    for (int row = 0; row < sensor.rows(); ++row) {
      const std::size_t begin = static_cast<std::size_t>(row) * scan.width;
      runs_.push_back({begin, begin + scan.width, static_cast<std::int16_t>(row)});
    }
    if (!rowsRise(scan, points, sensor)) return;
    for (RowRun& run : runs_) run.row = static_cast<std::int16_t>(sensor.rows() - 1 - run.row);
  } else if (scan.rings.known()) {
    source_ = VerticalIndexSource::RING_FIELD;
    rows_.resize(scan.size);
    for (std::size_t i = 0; i < scan.size; ++i) {
      const double ring = scan.rings[i];
      if (!(ring >= 0.0 && ring < sensor.rows())) {
        std::ostringstream message;
        message << "ring " << ring << " of point " << i << ": sensor model " << sensor.name << " has " << sensor.rows()
                << " rows";
        throw std::invalid_argument(message.str());
      }
      rows_[i] = static_cast<std::int16_t>(ring);
    }
    if (!rowsRise(scan, points, sensor)) return;
    for (std::int16_t& row : rows_) row = static_cast<std::int16_t>(sensor.rows() - 1 - row);
  } else if (findRuns(scan, points, sensor) && matchRunsToBeams(scan, points, sensor)) {
    source_ = VerticalIndexSource::FILE_ORDER;
  } else {
    source_ = VerticalIndexSource::ELEVATION_TABLE;
    assignFromElevation(scan, points, sensor);
  }
}

bool RingIndex::findRuns(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor) {
  const auto most_runs = static_cast<std::size_t>(sensor.rows());
  const auto fall = static_cast<std::int32_t>(sensor.columns * (kAzimuthFallOfNextRingDeg / 360.0));
  std::int32_t previous_column = -1;
  runs_.clear();
  runs_.reserve(most_runs);
  runs_.push_back({0, scan.size, 0});
  for (std::size_t block = 0; block < points.spans.size(); ++block) {
    const ColumnSpan span = points.spans[block];
    if (span.least > span.greatest) continue;
    const std::size_t begin = block * PointMeasurements::kBlock;
    const std::size_t end = std::min(begin + PointMeasurements::kBlock, scan.size);
    if (std::max<std::int32_t>(previous_column, span.greatest) - span.least <= fall) {
      std::size_t last = end - 1;
      while (points.column[last] == PointMeasurements::kNoColumn) --last;
      previous_column = points.column[last];
      continue;
    }
    for (std::size_t i = begin; i < end; ++i) {
      if (points.column[i] == PointMeasurements::kNoColumn) continue;
      const bool falls = points.column[i] < previous_column - fall;
      previous_column = points.column[i];
      if (!falls) continue;
      const std::size_t start = scan.point(i)[1] == 0.0F ? ringStartAtSeam(scan, points, i) : i;
      if (start == scan.size) continue;
      if (runs_.size() == most_runs) return false;
      runs_.back().end = start;
      runs_.push_back({start, scan.size, 0});
    }
  }
  return true;
}

bool RingIndex::matchRunsToBeams(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor) {
  const std::size_t runs = runs_.size();
  const auto rows = static_cast<std::size_t>(sensor.rows());
  run_elevations_.resize(runs);
  run_spreads_.resize(runs);
  for (std::size_t run = 0; run < runs; ++run) {
    const std::size_t end = runs_[run].end;
    const std::size_t step = std::max<std::size_t>(1, (end - runs_[run].begin) / kSamplesOfRun);
    samples_.clear();
    samples_.reserve(2 * kSamplesOfRun);
    for (std::size_t i = runs_[run].begin; i < end; i += step) {
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

  std::size_t row = rows;
  for (std::size_t run = runs; run-- > 0;) {
    do {
      --row;
    } while (taken_[run * rows + row] == 0);
    runs_[run].row = static_cast<std::int16_t>(row);
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
  rows_.resize(scan.size);
  for (std::size_t i = 0; i < scan.size; ++i) {
    rows_[i] = kNoRow;
    if (points.range[i] <= 0.0F) continue;
    const float point_sine = elevationSine(scan, points, i);
    if (point_sine > greatest || point_sine < least) continue;
    const auto below = std::upper_bound(beam_sines_.begin(), beam_sines_.end(), point_sine, std::greater<float>());
    rows_[i] = static_cast<std::int16_t>(below - beam_sines_.begin());
  }
}

bool RingIndex::rowsRise(const ScanView& scan, const PointMeasurements& points, const SensorModel& sensor) const {
  const std::size_t step = std::max<std::size_t>(1, scan.size / kSamplesOfScan);
  const double middle_row = 0.5 * (sensor.rows() - 1);
  double rows = 0.0;
  double sines = 0.0;
  double products = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < scan.size; i += step) {
    if (points.range[i] <= 0.0F) continue;
    const double row = (rowAfterRow() ? static_cast<std::int16_t>(i / scan.width) : rows_[i]) - middle_row;
    const double sine = elevationSine(scan, points, i);
    rows += row;
    sines += sine;
    products += row * sine;
    count += 1.0;
  }
  return products * count > rows * sines;
}

}  // namespace saw_ndt::internal
