#pragma once

#include <Eigen/Geometry>
#include <array>

#include "map/ndt_level.h"
#include "registration/ndt_objective.h"

namespace saw_ndt::internal {

/// How many voxels a neighbour is away along each axis.
struct Neighbour {
  int dx, dy, dz;
};

template <NeighborhoodSearchMethod method>
constexpr std::size_t kNeighbourCount = method == NeighborhoodSearchMethod::DIRECT1   ? 1
                                        : method == NeighborhoodSearchMethod::DIRECT3 ? 3
                                        : method == NeighborhoodSearchMethod::DIRECT7 ? 7
                                                                                      : 27;

template <NeighborhoodSearchMethod method>
constexpr std::array<Neighbour, kNeighbourCount<method>> neighbours() {
  std::array<Neighbour, kNeighbourCount<method>> result{};
  std::size_t count = 0;
  for (int z = -1; z <= 1; ++z) {
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        const int distance = x * x + y * y + z * z;
        if (method == NeighborhoodSearchMethod::DIRECT1 && distance > 0) continue;
        if (method == NeighborhoodSearchMethod::DIRECT3 && (x != 0 || y != 0)) continue;
        if (method == NeighborhoodSearchMethod::DIRECT7 && distance > 1) continue;
        result[count++] = {x, y, z};
      }
    }
  }
  return result;
}

/// Finds the voxels around source points at one pose. Positions are taken relative to a voxel near the source, so that
/// far from the map's origin no digit is lost.
class VoxelPairs {
 public:
  VoxelPairs(const internal::NdtLevel& level, const Eigen::Isometry3d& T_map_source)
      : level_(level), resolution_(level.resolution()), inverse_resolution_(1.0 / level.resolution()) {
    const Eigen::Vector3d origin_voxel = (T_map_source.translation() * inverse_resolution_).array().floor();
    translation_ = T_map_source.translation() - origin_voxel * resolution_;
    origin_ = origin_voxel.cast<int>();
  }

  /// Whether voxels near the pose can be numbered at all.
  static bool reachable(const internal::NdtLevel& level, const Eigen::Isometry3d& T_map_source) {
    return ((T_map_source.translation() / level.resolution()).array().abs() < kFarthestVoxel).all() &&
           T_map_source.linear().allFinite();
  }

  /// Calls visit(cell, qx, qy, qz) for every voxel that the rotated source point r (m) pairs with, q = T p - mean.
  template <NeighborhoodSearchMethod method, typename Visit>
  void forEach(const Eigen::Vector3d& r, Visit&& visit) {
    static constexpr std::array<Neighbour, kNeighbourCount<method>> kNeighbours = neighbours<method>();
    const Eigen::Vector3d p = r + translation_;
    const Eigen::Vector3d voxel = (p * inverse_resolution_).array().floor();
    if (!(voxel.array().abs() < kFarthestVoxel).all()) return;
    const internal::VoxelIndex::Place place = level_.index().place(voxel.cast<int>() + origin_, cursor_);
    if (!place) return;
    const Eigen::Vector3d from_centre = p - (voxel.array() + 0.5).matrix() * resolution_;
    const internal::NdtCell* cells = level_.cells().data();
    for (const Neighbour& neighbour : kNeighbours) {
      const std::int32_t number = place.number(neighbour.dx, neighbour.dy, neighbour.dz);
      if (number == internal::VoxelIndex::kNone) continue;
      const internal::NdtCell& cell = cells[static_cast<std::size_t>(number)];
      const double qx = from_centre.x() - neighbour.dx * resolution_ - cell.mean_from_centre[0];
      const double qy = from_centre.y() - neighbour.dy * resolution_ - cell.mean_from_centre[1];
      const double qz = from_centre.z() - neighbour.dz * resolution_ - cell.mean_from_centre[2];
      if (method == NeighborhoodSearchMethod::RADIUS && qx * qx + qy * qy + qz * qz > resolution_ * resolution_) {
        continue;
      }
      visit(cell, qx, qy, qz);
    }
  }

 private:
  // Voxels this far from the origin voxel, and an origin voxel this far out, still add up within 32 bits.
  static constexpr double kFarthestVoxel = 1.0e9;

  const internal::NdtLevel& level_;
  double resolution_, inverse_resolution_;
  Eigen::Vector3d translation_;
  VoxelCoordinate origin_;
  internal::VoxelIndex::Cursor cursor_;
};

/// C^-1 q of a cell.
struct WhitenedOffset {
  WhitenedOffset(const internal::NdtCell& cell, double qx, double qy, double qz) {
    const double* c = cell.inverse_covariance;
    x = c[0] * qx + c[1] * qy + c[2] * qz;
    y = c[1] * qx + c[3] * qy + c[4] * qz;
    z = c[2] * qx + c[4] * qy + c[5] * qz;
    squared_mahalanobis = qx * x + qy * y + qz * z;
  }
  double x, y, z;
  double squared_mahalanobis;
};

// A pair whose exponent is below -kLargestExponent adds less than 5e-18 of its amplitude: less than rounding.
constexpr double kLargestExponent = 40.0;

}  // namespace saw_ndt::internal
