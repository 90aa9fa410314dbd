#pragma once

#include <optional>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt::internal {

/// How long a gap between two poses of a recording may be (s) for one between them to be told.
constexpr double kLongestPoseGap_s = 1.0;

/// The pose at a share (0 to 1) of the way from one pose to another: the position on a straight line, the rotation by
/// the shortest turn at an even rate.
SAW_NDT_EXPORT Eigen::Isometry3d interpolatedPose(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to,
                                                  double share);

/// The pose of a trajectory, sorted by stamp, at a moment: one of its own where a stamp is the same, else that between
/// the two around it. Nothing in gaps of more than `longest_gap_s`, and outside of the trajectory but for a
/// millisecond, by which rounded stamps differ: there its first or last pose.
SAW_NDT_EXPORT std::optional<Eigen::Isometry3d> poseAt(const std::vector<StampedPose>& trajectory, double stamp_s,
                                                       double longest_gap_s);

}  // namespace saw_ndt::internal
