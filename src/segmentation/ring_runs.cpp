#include "segmentation/ring_runs.h"

#include <algorithm>
#include <cmath>

namespace saw_ndt::internal {
namespace {

// A smaller fall is a point that parallax or motion compensation put behind its predecessor (10 degrees on KITTI).
constexpr double kAzimuthFallOfNextRingDeg = 200.0;

// Where the next ring begins, if the azimuth falls at a point with y = 0. That is rounded from just before or just
// after a whole turn: the point ends the ring above or begins the one below, whichever beam it fits. scan.size: no ring
// begins.
std::size_t ringStartAtSeam(const ScanView& scan, const PointMeasurements& points, std::size_t seam) {
  std::size_t before = seam - 1;
  while (points.range[before] <= 0.0F) --before;
  std::size_t after = seam + 1;
  while (after < scan.size && points.range[after] <= 0.0F) ++after;
  if (after == scan.size) return scan.size;
  const float sine = points.elevationSine(scan, seam);
  const float to_ring_above = std::abs(sine - points.elevationSine(scan, before));
  const float to_ring_below = std::abs(sine - points.elevationSine(scan, after));
  return to_ring_above < to_ring_below ? after : seam;
}

// Whether the azimuth falls from most points to those behind them, as in scans of sensors that turn clockwise.
bool azimuthFalls(const PointMeasurements& points, int columns) {
  constexpr std::size_t kSamples = 256;
  const std::size_t step = std::max<std::size_t>(1, points.column.size() / kSamples);
  std::ptrdiff_t balance = 0;
  for (std::size_t i = 1; i < points.column.size(); i += step) {
    if (points.column[i - 1] == PointMeasurements::kNoColumn || points.column[i] == PointMeasurements::kNoColumn) {
      continue;
    }
    const int change = points.column[i] - points.column[i - 1];
    if (std::abs(change) < columns / 8) balance += (change < 0) - (change > 0);
  }
  return balance > 0;
}

}  // namespace

bool findRuns(const ScanView& scan, const PointMeasurements& points, int columns, std::size_t most_runs,
              std::vector<RowRun>& runs) {
  const auto fall = static_cast<std::int32_t>(columns * (kAzimuthFallOfNextRingDeg / 360.0));
  // Columns are counted in the direction of the scan, so that they always rise within a ring.
  const std::int32_t mirror = azimuthFalls(points, columns) ? columns - 1 : 0;
  const auto place = [mirror](std::uint16_t column) { return mirror > 0 ? mirror - column : std::int32_t{column}; };
  std::int32_t previous = -1;
  runs.clear();
  runs.reserve(most_runs);
  runs.push_back({0, scan.size, 0});
  for (std::size_t block = 0; block < points.spans.size(); ++block) {
    const ColumnSpan span = points.spans[block];
    if (span.least > span.greatest) continue;
    const std::size_t begin = block * PointMeasurements::kBlock;
    const std::size_t end = std::min(begin + PointMeasurements::kBlock, scan.size);
    const auto [least, greatest] = std::minmax({place(span.least), place(span.greatest)});
    if (std::max(previous, greatest) - least <= fall) {
      std::size_t last = end - 1;
      while (points.column[last] == PointMeasurements::kNoColumn) --last;
      previous = place(points.column[last]);
      continue;
    }
    for (std::size_t i = begin; i < end; ++i) {
      if (points.column[i] == PointMeasurements::kNoColumn) continue;
      const bool falls = place(points.column[i]) < previous - fall;
      previous = place(points.column[i]);
      if (!falls) continue;
      const std::size_t start = scan.point(i)[1] == 0.0F ? ringStartAtSeam(scan, points, i) : i;
      if (start == scan.size) continue;
      if (runs.size() == most_runs) return false;
      runs.back().end = start;
      runs.push_back({start, scan.size, 0});
    }
  }
  return true;
}

}  // namespace saw_ndt::internal
