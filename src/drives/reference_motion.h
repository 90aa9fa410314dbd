#pragma once

#include <optional>
#include <vector>

#include "localization/motion_compensation.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt::internal {

/// The motion of a LiDAR during the scan that was taken at a stamp: from its pose before to that at the stamp, and on
/// to the one behind. Where one of the two is missing, or more than a second away, the motion of the other side is that
/// of this side, too.
/// @param T_map_lidar  by growing stamps
/// @return nothing where no pose has that stamp (to 1 ms), or neither neighbour is near enough
std::optional<ScanMotion> motionAt(const std::vector<StampedPose>& T_map_lidar, double stamp_s);

}  // namespace saw_ndt::internal
