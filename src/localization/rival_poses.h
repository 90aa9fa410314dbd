#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/registration/alignment.h"
#include "saw_ndt/registration/source_points.h"

namespace saw_ndt::internal {

/// How far apart poses must be to count as different places (m).
constexpr double kOtherPlace_m = 1.0;

/// Where else on the way that a pose is held least, such as along a road, a scan may have been taken: the poses at
/// which most points lie on surfaces of the map, in the sense of advantage(), the best first, four at most.
/// @param covariance  of the pose, as AlignmentResult::covariance
/// @param radius_m    how far to look both ways
std::vector<Eigen::Isometry3d> rivalPoses(const NdtTarget& target, const SourcePoints& source,
                                          const Eigen::Isometry3d& T_map_source, const Matrix6d& covariance,
                                          double radius_m, int threads);

/// How sure it is that a scan was taken at one pose rather than at a rival: the difference between the numbers of
/// points that lie on a surface of the map at one of them alone, in standard deviations (a sign test). Negative: the
/// rival explains more.
double advantage(const NdtTarget& target, const SourcePoints& source, const Eigen::Isometry3d& T_map_source,
                 const Eigen::Isometry3d& T_map_source_rival);

}  // namespace saw_ndt::internal
