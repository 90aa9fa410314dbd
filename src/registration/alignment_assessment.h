#pragma once

#include <cstddef>
#include <vector>

#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/registration/alignment.h"
#include "saw_ndt/registration/source_points.h"

namespace saw_ndt::internal {

/// Tells from a sample of the source points what the pose of an alignment rests on.
/// @param result  has pose and information; overlap, covariance and free directions are filled in, and a converged one
///                becomes UNDETERMINED where too little fits
void assessAlignment(const NdtTarget& target, const SourcePoints& source, const AlignmentOptions& options,
                     AlignmentResult& result);

/// Which of a sample of the source points that are not ground, every `stride`-th of all, lie on a surface of the map.
std::vector<bool> pointsOnSurfaces(const NdtTarget& target, const SourcePoints& source,
                                   const Eigen::Isometry3d& T_map_source, std::size_t stride);

}  // namespace saw_ndt::internal
