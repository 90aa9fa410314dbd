#pragma once

#include <Eigen/Geometry>

#include "map/ndt_level.h"
#include "registration/batch_workspace.h"
#include "registration/levelled_source.h"
#include "saw_ndt/common/export.h"
#include "saw_ndt/registration/alignment.h"
#include "saw_ndt/registration/source_points.h"

namespace saw_ndt::internal {

/// Of each level's points on that level. In single precision; the same bits for any number of threads.
Likelihoods evaluateLikelihoods(const NdtTarget& target, LevelledSource& source, const Eigen::Isometry3d& T_map_source,
                                double outlier_ratio, int threads, BatchWorkspace& workspace);
/// Of all points on one level.
SAW_NDT_EXPORT Likelihoods evaluateLikelihoods(const NdtLevel& level, OrderedSource& source,
                                               const Eigen::Isometry3d& T_map_source, double outlier_ratio, int threads,
                                               BatchWorkspace& workspace);
/// The same in one thread, and without putting points in an order that suits the pose.
Likelihoods likelihoodsInOrder(const NdtLevel& level, const OrderedSource& source,
                               const Eigen::Isometry3d& T_map_source, double outlier_ratio, BatchScratch& scratch);
/// The same for points in any order.
SAW_NDT_EXPORT Likelihoods evaluateLikelihoods(const NdtLevel& level, const SourcePoints& source,
                                               const Eigen::Isometry3d& T_map_source, double outlier_ratio,
                                               int threads);

}  // namespace saw_ndt::internal
