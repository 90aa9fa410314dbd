#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "saw_ndt/common/scan_view.h"
#include "segmentation/point_measurements.h"

namespace saw_ndt::internal {

/// Successive points of one row.
struct RowRun {
  std::size_t begin;
  std::size_t end;
  std::int16_t row;
};

/// A run of points that are mostly farther than this from its median elevation (degrees) holds several rings: where
/// most of a ring has no return, nothing tells where it ends. On KITTI none is above 0.5 degrees.
constexpr float kGreatestSpreadOfRunDeg = 1.5F;
/// The share of a scan's points in such runs from which its order tells nothing.
constexpr double kMostPointsInSpreadRuns = 0.05;

/// Finds the rings of a scan that lists one after the other, from azimuth 0 round to 0 again in either direction; their
/// rows are left 0.
/// @param columns  that the points were measured for
/// @return false where there are more runs than most_runs, as in a scan of another order
bool findRuns(const ScanView& scan, const PointMeasurements& points, int columns, std::size_t most_runs,
              std::vector<RowRun>& runs);

}  // namespace saw_ndt::internal
