#include "saw_ndt/map/voxel_statistics.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace saw_ndt {
namespace {

struct MeanAndCovariance {
  Eigen::Vector3d mean;        // m, from the centre
  Eigen::Matrix3d covariance;  // m^2, sample covariance (N - 1)
};

// The sums are first moved, in integers, to within half a step of the mean: what is left to subtract in floating point
// is then tiny and nothing cancels.
MeanAndCovariance meanAndCovariance(const VoxelSums& sums, double metres_per_step) {
  const auto count = static_cast<double>(sums.count);
  std::array<std::int64_t, 3> to_mean;
  for (std::size_t i = 0; i < 3; ++i) to_mean[i] = -std::llround(static_cast<double>(sums.sum[i]) / count);
  const VoxelSums centred = sums.shifted(to_mean);

  MeanAndCovariance result;
  Eigen::Vector3d residual;
  for (int i = 0; i < 3; ++i) {
    residual[i] = static_cast<double>(centred.sum[i]) / count;
    result.mean[i] = (residual[i] - static_cast<double>(to_mean[i])) * metres_per_step;
  }
  std::size_t k = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j, ++k) {
      const double scatter = static_cast<double>(centred.product[k]) - count * residual[i] * residual[j];
      result.covariance(i, j) = result.covariance(j, i) = scatter / (count - 1.0) * (metres_per_step * metres_per_step);
    }
  }
  return result;
}

}  // namespace

StructureClass structureClass(const Eigen::Vector3d& eigenvalues) {
  Eigen::Vector3d sigma = eigenvalues.cwiseMax(0.0).cwiseSqrt();
  std::sort(sigma.data(), sigma.data() + 3);
  const double linear = sigma[2] - sigma[1];
  const double planar = sigma[1] - sigma[0];
  const double volumetric = sigma[0];
  if (linear >= planar && linear >= volumetric) return StructureClass::Linear;
  return planar >= volumetric ? StructureClass::Planar : StructureClass::Volumetric;
}

std::optional<VoxelStatistics> voxelStatistics(const VoxelCoordinate& voxel, const VoxelSums& sums,
                                               double mean_confidence, const VoxelWeighting& weighting,
                                               double metres_per_step) {
  if (sums.count < static_cast<std::uint64_t>(weighting.min_points_per_voxel)) return std::nullopt;
  const MeanAndCovariance moments = meanAndCovariance(sums, metres_per_step);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments.covariance);
  const Eigen::Vector3d eigenvalues = solver.eigenvalues();
  if (!(eigenvalues[2] > 0.0)) return std::nullopt;

  VoxelStatistics statistics;
  statistics.voxel = voxel;
  statistics.point_count = sums.count;
  statistics.mean_from_centre = moments.mean;
  const Eigen::Vector3d raised = eigenvalues.cwiseMax(weighting.min_eigenvalue_ratio * eigenvalues[2]);
  const Eigen::Matrix3d& axes = solver.eigenvectors();
  statistics.covariance = axes * raised.asDiagonal() * axes.transpose();
  statistics.inverse_covariance = axes * raised.cwiseInverse().asDiagonal() * axes.transpose();
  statistics.mean_confidence = mean_confidence;
  statistics.structure_class = structureClass(eigenvalues);
  statistics.weight = mean_confidence * weighting.alpha(statistics.structure_class);
  return statistics;
}

}  // namespace saw_ndt
