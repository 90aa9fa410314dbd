#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/stamped_pose.h"

namespace saw_ndt {

/// Two stamps no farther apart than this are of the same scan.
constexpr double kStampTolerance_s = 0.01;

/// An estimated pose and the reference of the same scan, both in the map frame.
struct PosePair {
  double stamp_s = 0.0;  ///< of the estimate
  Eigen::Isometry3d T_map_reference = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_map_estimate = Eigen::Isometry3d::Identity();
};

/// Gives each estimated pose the reference pose nearest in time, in the order of the estimate's stamps.
///
/// Poses without a reference within kStampTolerance_s are left out, and so are those of the first `skip_s` seconds,
/// counted from the estimate's first stamp (a pose at exactly skip_s counts). Throws std::invalid_argument, saying why,
/// where no pair is left, where skip_s is negative, and where a pose or stamp is not finite.
SAW_NDT_EXPORT std::vector<PosePair> matchTrajectories(const std::vector<StampedPose>& reference,
                                                       const std::vector<StampedPose>& estimate, double skip_s);

}  // namespace saw_ndt
