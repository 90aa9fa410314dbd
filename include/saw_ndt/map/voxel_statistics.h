#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "saw_ndt/common/export.h"
#include "saw_ndt/map/voxel_sums.h"
#include "saw_ndt/map/voxel_weighting.h"

namespace saw_ndt {

/// The normal distribution of one voxel, its class and its weight.
struct VoxelStatistics {
  VoxelCoordinate voxel = VoxelCoordinate::Zero();
  std::uint64_t point_count = 0;
  Eigen::Vector3d mean_from_centre = Eigen::Vector3d::Zero();  ///< m, from the centre of the voxel
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();        ///< m^2, its small eigenvalues raised; invertible
  Eigen::Matrix3d inverse_covariance = Eigen::Matrix3d::Zero();
  double mean_confidence = 0.0;  ///< mean structural confidence of the points
  StructureClass structure_class = StructureClass::VOLUMETRIC;
  double weight = 0.0;        ///< w_target of the paper
  double ground_share = 0.0;  ///< share of the points labelled ground

  /// The mean in the map frame (m).
  Eigen::Vector3d mean(double resolution_m) const {
    return (voxel.cast<double>().array() + 0.5).matrix() * resolution_m + mean_from_centre;
  }
};

/// The structure class by the square roots of the eigenvalues (any order, negative ones count as 0) of a sample
/// covariance, as in Section III.B of the paper.
SAW_NDT_EXPORT StructureClass structureClass(const Eigen::Vector3d& eigenvalues);

/// The statistics of the points that `sums` hold.
/// @param mean_confidence  mean of the structural confidences of those points
/// @param metres_per_step  size of the step in which `sums` count
/// @return nothing for fewer than min_points_per_voxel points, or when all of them coincide
SAW_NDT_EXPORT std::optional<VoxelStatistics> voxelStatistics(const VoxelCoordinate& voxel, const VoxelSums& sums,
                                                              double mean_confidence, const VoxelWeighting& weighting,
                                                              double metres_per_step);

}  // namespace saw_ndt
