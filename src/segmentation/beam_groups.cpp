#include "segmentation/beam_groups.h"

#include <algorithm>
#include <cmath>

#include "common/middle_value.h"
#include "common/rows_and_columns.h"
#include "saw_ndt/common/geometry.h"
#include "segmentation/point_measurements.h"
#include "segmentation/ring_runs.h"

namespace saw_ndt::internal {
namespace {

constexpr char kFileOrder[] = "file order";
constexpr int kLeastBeams = 4;
constexpr std::size_t kLeastPoints = 8;
// Sensors measure from a ring of some centimetres rather than from a point: near returns are off their beam.
constexpr float kLeastRange_m = 1.0F;

struct Direction {
  double elevation_deg;
  double azimuth_deg;
};

/// One group's median figures.
BeamGroup groupOf(int number, const std::vector<Direction>& directions) {
  BeamGroup group;
  group.number = number;
  group.points = directions.size();
  std::vector<double> values;
  for (const Direction& direction : directions) values.push_back(direction.elevation_deg);
  group.elevation_deg = middleValue(values);
  for (double& value : values) value = std::abs(value - group.elevation_deg);
  group.spread_deg = middleValue(values);
  values.clear();
  for (const Direction& direction : directions) values.push_back(direction.azimuth_deg);
  std::sort(values.begin(), values.end());
  // Two returns of one firing have the same azimuth, but for rounding.
  constexpr double kLeastStep_deg = 0.01;
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] - values[i - 1] > kLeastStep_deg) steps.push_back(values[i] - values[i - 1]);
  }
  if (steps.size() >= kLeastPoints) group.step_deg = middleValue(steps);
  return group;
}

template <typename GroupOfPoint>
BeamGroups grouped(const std::string& evidence, const ScanView& scan, const PointMeasurements& points, int count,
                   const GroupOfPoint& group_of_point) {
  BeamGroups result;
  result.evidence = evidence;
  result.count = count;
  result.numbered = evidence != kFileOrder;
  std::vector<std::vector<Direction>> directions(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < scan.size; ++i) {
    if (points.range[i] < kLeastRange_m || points.range[i] > kFarthestReturn_m) continue;
    const float* const p = scan.point(i);
    const double sine = std::clamp(static_cast<double>(points.elevationSine(scan, i)), -1.0, 1.0);
    directions[static_cast<std::size_t>(group_of_point(i))].push_back(
        {degreesFromRadians(std::asin(sine)), degreesFromRadians(std::atan2(p[1], p[0]))});
  }
  for (int number = 0; number < count; ++number) {
    const std::vector<Direction>& of_group = directions[static_cast<std::size_t>(number)];
    if (of_group.size() < kLeastPoints) continue;
    const BeamGroup group = groupOf(number, of_group);
    if (std::abs(group.elevation_deg) < kSteepestBeam_deg) result.groups.push_back(group);
  }
  return result;
}

/// How many rings there are; 0 where numbers are none of rings.
int ringCount(const ScanView& scan) {
  int count = 0;
  for (std::size_t i = 0; i < scan.size; ++i) {
    const double ring = scan.rings[i];
    if (!(ring >= 0.0 && ring < static_cast<double>(kMostBeams)) || ring != std::floor(ring)) return 0;
    count = std::max(count, static_cast<int>(ring) + 1);
  }
  return count;
}

}  // namespace

bool BeamGroups::areBeams() const {
  if (groups.size() < static_cast<std::size_t>(kLeastBeams)) return false;
  std::vector<double> spreads, elevations, gaps;
  double points = 0.0, points_spread = 0.0;
  for (const BeamGroup& group : groups) {
    points += static_cast<double>(group.points);
    if (group.spread_deg > static_cast<double>(kGreatestSpreadOfRunDeg))
      points_spread += static_cast<double>(group.points);
    spreads.push_back(group.spread_deg);
    elevations.push_back(group.elevation_deg);
  }
  if (!numbered && points_spread > kMostPointsInSpreadRuns * points) return false;
  std::sort(elevations.begin(), elevations.end());
  for (std::size_t i = 1; i < elevations.size(); ++i) gaps.push_back(elevations[i] - elevations[i - 1]);
  return middleValue(spreads) < middleValue(gaps);
}

bool BeamGroups::areInOrder() const {
  constexpr double kLeastShare = 0.9;
  std::size_t rising = 0, falling = 0;
  for (std::size_t i = 1; i < groups.size(); ++i) {
    ++(groups[i].elevation_deg > groups[i - 1].elevation_deg ? rising : falling);
  }
  return static_cast<double>(std::max(rising, falling)) >= kLeastShare * static_cast<double>(rising + falling);
}

std::vector<BeamGroups> beamGroupsOf(const ScanView& scan) {
  std::vector<BeamGroups> found;
  PointMeasurements points;
  constexpr int kColumns = 4096;
  measureScan(scan, {}, kColumns, 1, points);
  if (scan.rings.known()) {
    if (const int count = ringCount(scan); count > 0) {
      found.push_back(
          grouped("rings", scan, points, count, [&](std::size_t i) { return static_cast<int>(scan.rings[i]); }));
    }
  }
  if (isOrganized(scan)) {
    if (scan.height <= kMostBeams) {
      found.push_back(grouped("rows", scan, points, static_cast<int>(scan.height),
                              [&](std::size_t i) { return static_cast<int>(i / scan.width); }));
    }
    if (scan.width <= kMostBeams) {
      found.push_back(grouped("rows", scan, points, static_cast<int>(scan.width),
                              [&](std::size_t i) { return static_cast<int>(i % scan.width); }));
    }
  }
  std::vector<RowRun> runs;
  if (scan.size > 0 && findRuns(scan, points, kColumns, static_cast<std::size_t>(kMostBeams), runs)) {
    std::vector<int> run_of_point(scan.size);
    for (std::size_t run = 0; run < runs.size(); ++run) {
      std::fill(run_of_point.begin() + static_cast<std::ptrdiff_t>(runs[run].begin),
                run_of_point.begin() + static_cast<std::ptrdiff_t>(runs[run].end), static_cast<int>(run));
    }
    found.push_back(grouped(kFileOrder, scan, points, static_cast<int>(runs.size()),
                            [&](std::size_t i) { return run_of_point[i]; }));
  }
  return found;
}

}  // namespace saw_ndt::internal
