#pragma once

#include <vector>

#include "io/csv_table.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt::internal {

/// The poses of a CSV file; readTrajectory() says how its columns are told. Throws Error that names the line, or the
/// columns where some are missing or named twice.
std::vector<StampedPose> csvPoses(const CsvTable& table);

}  // namespace saw_ndt::internal
