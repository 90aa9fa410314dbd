#pragma once

#include <string>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/evaluation/pose_pairs.h"

namespace saw_ndt {

/// What is taken off an estimate before its absolute errors are told.
enum class TrajectoryAlignment {
  NONE,    ///< nothing: the estimate answers for its frame
  ORIGIN,  ///< the first pose of the pairs becomes the reference's
  YAW,     ///< the best translation and turn about the vertical: both frames know where up is
  SE3,     ///< the best rigid transform
};

/// "none", "origin", "yaw", "se3"
SAW_NDT_EXPORT std::string toString(TrajectoryAlignment alignment);

/// The transform T that is to be put before the estimated poses.
///
/// ORIGIN: T = T_map_reference T_map_estimate^-1 of the first pair. SE3 minimizes sum |r - T e|^2 over the positions r
/// of the reference and e of the estimate (Umeyama's solution without scale): with the covariance C = sum (r - mean r)
/// (e - mean e)^T = U D V^T, R = U diag(1, 1, det U det V) V^T and t = mean r - R mean e. YAW minimizes the same over
/// turns about z: its angle is atan2(C_yx - C_xy, C_xx + C_yy).
///
/// Throws std::invalid_argument where there is no pair, and where the positions do not tell the rotation: for SE3 where
/// those of one trajectory are the same or on one line, for YAW where they are the same seen from above. They are taken
/// to be where the second singular value of C (for YAW, the length of the vector whose angle it is) is below 1e-12 of
/// the first, or the whole below a square micrometre a pair.
SAW_NDT_EXPORT Eigen::Isometry3d alignmentTransform(const std::vector<PosePair>& pairs, TrajectoryAlignment alignment);

/// The pairs with alignmentTransform() put before the estimated poses.
SAW_NDT_EXPORT std::vector<PosePair> alignedPairs(std::vector<PosePair> pairs, TrajectoryAlignment alignment);

}  // namespace saw_ndt
