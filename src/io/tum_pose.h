#pragma once

#include <ostream>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt::internal {

/// Writes a line as writeTumTrajectory() does.
SAW_NDT_EXPORT void writeTumPose(std::ostream& stream, const StampedPose& pose);

}  // namespace saw_ndt::internal
