#pragma once

#include <Eigen/Core>

#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/registration/alignment.h"
#include "saw_ndt/registration/source_points.h"

namespace saw_ndt::internal {

/// Tells from a sample of the source points what the pose of an alignment rests on.
/// @param result  has pose and information; overlap, covariance and free directions are filled in, and a converged one
///                becomes UNDETERMINED where too little fits
void assessAlignment(const NdtTarget& target, const SourcePoints& source, const AlignmentOptions& options,
                     AlignmentResult& result);

/// Whether a point in the map lies on a surface of it, within three standard deviations.
bool liesOnSurface(const NdtTarget& target, const Eigen::Vector3d& position_m);

}  // namespace saw_ndt::internal
