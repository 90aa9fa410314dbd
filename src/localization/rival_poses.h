#pragma once

#include <Eigen/Geometry>
#include <cstddef>
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

/// Compares how many points of a sample of what is not ground lie on surfaces of the map at two poses. Points of a cell
/// of 1 m fit or not together, so that cells, not points, count as independent.
class FitComparison {
 public:
  /// Which points of the sample lie on surfaces at a pose.
  using Fits = std::vector<bool>;

  FitComparison(const NdtTarget& target, const SourcePoints& source, std::size_t most_points);

  Fits fitsAt(const Eigen::Isometry3d& T_map_source) const;
  /// How sure it is that a scan was taken here rather than there: the difference between the numbers of points that lie
  /// on a surface at one of them alone, in standard deviations (a sign test). Negative: more do there.
  double advantage(const Fits& here, const Fits& there) const;

 private:
  NdtTarget target_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<std::size_t> cell_of_point_;
  std::size_t cell_count_ = 0;
};

/// Where else on a way a scan may have been taken: the four places at which most points lie on surfaces of the map, in
/// the sense of FitComparison::advantage(), and places next to the pose. Alignments from there show it.
/// @param radius_m      how far to look both ways
/// @param is_expected   the vehicle was to be there: only places that fit nearly as well as they are
std::vector<Eigen::Isometry3d> rivalStarts(const NdtTarget& target, const SourcePoints& source,
                                           const Eigen::Isometry3d& T_map_source, const SearchedWay& way,
                                           double radius_m, bool is_expected, int threads);

}  // namespace saw_ndt::internal
