#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "map/voxel_index.h"
#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt::internal {

/// The points of a voxel, whatever their labels, as a piece of a surface.
struct Surface {
  VoxelCoordinate voxel;
  Eigen::Vector3f mean_from_centre;  ///< m
  Eigen::Matrix3f covariance;        ///< m^2; of a whole voxel for points too few to tell it
  Eigen::Vector3f normal;            ///< of unit length, along the least of the covariance; either way
  std::uint64_t point_count = 0;
  std::uint32_t scan_count = 0;  ///< of the label that most scans met; 0: not known
  StructuralLabel label = StructuralLabel::NON_GROUND;
  bool flat = false;  ///< thin, and seen over enough of its extent to have a normal
};

/// The points of this many or more make a surface.
constexpr int kLeastPointsOfSurface = 3;

/// The surfaces of a map, to be compared with those of another one.
class MapSurfaces {
 public:
  /// @param threads  0: all cores
  MapSurfaces(const WeightedVoxelMap& map, int threads);

  /// In map order.
  const std::vector<Surface>& all() const { return surfaces_; }
  double resolution() const { return resolution_m_; }

  /// Calls visit(number of a surface) for the voxel itself, then for those that touch it, until one returns true.
  /// @return whether one did
  template <typename Visit>
  bool anyAround(const VoxelCoordinate& voxel, VoxelIndex::Cursor& cursor, const Visit& visit) const {
    const VoxelIndex::Place place = index_.place(voxel, cursor);
    if (!place) return false;
    const auto visitAt = [&](int dx, int dy, int dz) {
      const std::int32_t number = place.number(dx, dy, dz);
      return number != VoxelIndex::kNone && visit(static_cast<std::size_t>(number));
    };
    if (visitAt(0, 0, 0)) return true;
    for (int i = 0; i < 27; ++i) {
      if (i != 13 && visitAt(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)) return true;
    }
    return false;
  }

 private:
  double resolution_m_;
  std::vector<Surface> surfaces_;
  VoxelIndex index_;
};

/// How two surfaces lie to each other.
struct SurfacePair {
  bool both_flat = false;     ///< and their normals agree
  float gap_m = 0.0F;         ///< along the mean normal, from the first to the second; flat pairs
  float gap_sigma_m = 0.0F;   ///< its standard deviation by what is known of both means and normals
  Eigen::Vector3f normal;     ///< of flat pairs, the greatest of its coordinates positive
  float mahalanobis2 = 0.0F;  ///< squared distance of the means by the sum of both covariances; other pairs
};

/// Exchanging both turns the sign of the gap, to the last bit.
SurfacePair pairOf(const Surface& first, const Surface& second, double resolution_m);

}  // namespace saw_ndt::internal
