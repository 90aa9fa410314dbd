#pragma once

#include <Eigen/Geometry>

#include "map/ndt_level.h"
#include "registration/batch_workspace.h"
#include "registration/ordered_source.h"
#include "saw_ndt/registration/alignment.h"
#include "saw_ndt/registration/source_points.h"

namespace saw_ndt {

/// In single precision; the same bits for any number of threads.
Likelihoods evaluateLikelihoods(const internal::NdtLevel& level, OrderedSource& source,
                                const Eigen::Isometry3d& T_map_source, double outlier_ratio, int threads,
                                BatchWorkspace& workspace);
/// The same for points in any order.
Likelihoods evaluateLikelihoods(const internal::NdtLevel& level, const SourcePoints& source,
                                const Eigen::Isometry3d& T_map_source, double outlier_ratio, int threads);

}  // namespace saw_ndt
