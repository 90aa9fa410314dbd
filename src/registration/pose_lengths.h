#pragma once

#include "saw_ndt/common/geometry.h"
#include "saw_ndt/registration/alignment.h"

namespace saw_ndt::internal {

/// A difference of poses (m, rad) with rotations as the way of a point kRotationArm_m away, as PoseDirections are.
inline Vector6d inLengths(Vector6d difference) {
  difference.tail<3>() *= kRotationArm_m;
  return difference;
}

/// The matrix that leaves of a difference of poses (m, rad) what lies along directions.
inline Matrix6d projectorOnto(const PoseDirections& directions) {
  const Vector6d lengths = inLengths(Vector6d::Ones());
  return lengths.cwiseInverse().asDiagonal() * (directions * directions.transpose()).eval() * lengths.asDiagonal();
}

}  // namespace saw_ndt::internal
