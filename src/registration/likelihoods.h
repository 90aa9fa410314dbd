#pragma once

#include <Eigen/Geometry>

#include "map/ndt_level.h"
#include "registration/batch_workspace.h"
#include "registration/ordered_source.h"
#include "saw_ndt/registration/source_points.h"

namespace saw_ndt {

/// How well a pose explains a source, in figures that weights do not change. Each is of Magnusson's score function.
struct Likelihoods {
  double unweighted = 0.0;  ///< sum over all pairs / number of source points: PCL's, with every weight 1
  /// The same over the points not labelled ground. The ground keeps the others high where a pose is lost along a road.
  double non_ground = 0.0;
  double nearest_voxel = 0.0;  ///< mean over the points that meet a voxel of the score of their best voxel
};

/// In single precision; the same bits for any number of threads.
Likelihoods evaluateLikelihoods(const internal::NdtLevel& level, OrderedSource& source,
                                const Eigen::Isometry3d& T_map_source, double outlier_ratio, int threads,
                                BatchWorkspace& workspace);
/// The same for points in any order.
Likelihoods evaluateLikelihoods(const internal::NdtLevel& level, const SourcePoints& source,
                                const Eigen::Isometry3d& T_map_source, double outlier_ratio, int threads);

}  // namespace saw_ndt
