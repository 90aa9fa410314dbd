#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/registration/alignment.h"
#include "saw_ndt/registration/source_points.h"

namespace saw_ndt::internal {

/// The horizontal direction along which a pose is held least, such as that of a road: a unit vector in the map.
/// @param covariance  of the pose, as AlignmentResult::covariance
Eigen::Vector3d leastHeldDirection(const Matrix6d& covariance);

/// A way on which poses are looked for.
struct SearchedWay {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< at the pose, a unit vector in the map
  Eigen::Vector3d turn_per_m = Eigen::Vector3d::Zero();  ///< rotation vector in the map, of a road that bends
};

/// Where else on a way a scan may have been taken: places next to the pose, and the four farther ones at which most
/// points lie on surfaces of the map, in the sense of advantage(). Alignments from there show it.
/// @param radius_m  how far to look both ways
std::vector<Eigen::Isometry3d> rivalStarts(const NdtTarget& target, const SourcePoints& source,
                                           const Eigen::Isometry3d& T_map_source, const SearchedWay& way,
                                           double radius_m, int threads);

/// How sure it is that a scan was taken at one pose rather than at a rival: the difference between the numbers of
/// points that lie on a surface of the map at one of them alone, in standard deviations (a sign test). Negative: the
/// rival explains more.
double advantage(const NdtTarget& target, const SourcePoints& source, const Eigen::Isometry3d& T_map_source,
                 const Eigen::Isometry3d& T_map_source_rival);

}  // namespace saw_ndt::internal
