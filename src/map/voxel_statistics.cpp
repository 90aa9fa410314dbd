#include "saw_ndt/map/voxel_statistics.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "map/merged_voxel.h"
#include "map/symmetric_eigen.h"

namespace saw_ndt {
namespace {
using namespace internal;

std::int64_t rounded(double value) { return static_cast<std::int64_t>(value < 0.0 ? value - 0.5 : value + 0.5); }

// The mean (m, from the centre) and, as matrix `place`, the sample covariance (m^2, N - 1). The sums are first moved,
// in integers, to within half a step of the mean: what is left to subtract in floating point is then tiny and nothing
// cancels.
Eigen::Vector3d meanAndCovariance(const VoxelSums& sums, double metres_per_step, SymmetricMatrices& covariances,
                                  std::size_t place) {
  const auto count = static_cast<double>(sums.count);
  std::array<std::int64_t, 3> to_mean;
  for (std::size_t i = 0; i < 3; ++i) to_mean[i] = -rounded(static_cast<double>(sums.sum[i]) / count);
  const VoxelSums centred = sums.shifted(to_mean);

  Eigen::Vector3d mean;
  std::array<double, 3> residual;
  for (std::size_t i = 0; i < 3; ++i) {
    residual[i] = static_cast<double>(centred.sum[i]) / count;
    mean[static_cast<int>(i)] = (residual[i] - static_cast<double>(to_mean[i])) * metres_per_step;
  }
  std::size_t k = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i; j < 3; ++j, ++k) {
      const double scatter = static_cast<double>(centred.product[k]) - count * residual[i] * residual[j];
      covariances.element[k][place] = scatter / (count - 1.0) * (metres_per_step * metres_per_step);
    }
  }
  return mean;
}

// The sum of factor times the outer product of a vector with itself, over the eigenvectors.
Eigen::Matrix3d composed(const SymmetricMatrices& matrices, std::size_t place, const Eigen::Vector3d& factors) {
  double sums[6] = {};
  for (std::size_t which = 0; which < 3; ++which) {
    const auto& vector = matrices.eigenvector[which];
    std::size_t k = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double scaled = factors[static_cast<int>(which)] * vector[i][place];
      for (std::size_t j = i; j < 3; ++j, ++k) sums[k] += scaled * vector[j][place];
    }
  }
  Eigen::Matrix3d matrix;
  matrix << sums[0], sums[1], sums[2], sums[1], sums[3], sums[4], sums[2], sums[4], sums[5];
  return matrix;
}

// A voxel is flat where its least eigenvalue is less than this share of the second.
constexpr double kFlat = 0.1;
// What the other two eigenvalues of unbounded ground are multiplied by: to ten voxels and more across.
constexpr double kUnbounded = 100.0;

// Raises the eigenvalues of matrix `place` and completes what is known of the voxel so far; false where all of its
// points coincide or spread too little.
bool complete(const SymmetricMatrices& matrices, std::size_t place, const VoxelWeighting& weighting,
              double min_spread_m, bool unbounded, VoxelStatistics& statistics) {
  const Eigen::Vector3d eigenvalues(matrices.eigenvalue[0][place], matrices.eigenvalue[1][place],
                                    matrices.eigenvalue[2][place]);
  const double greatest = eigenvalues.maxCoeff();
  if (!(greatest > 0.0)) return false;
  Eigen::Vector3d sorted = eigenvalues;
  std::sort(sorted.data(), sorted.data() + 3);
  const double second = sorted[1];
  if (second < min_spread_m * min_spread_m) return false;
  Eigen::Vector3d raised = eigenvalues.cwiseMax(weighting.min_eigenvalue_ratio * greatest);
  int across = 0;
  if (unbounded && eigenvalues.minCoeff(&across) < kFlat * second) {
    for (int i = 0; i < 3; ++i) raised[i] *= i == across ? 1.0 : kUnbounded;
  }
  statistics.covariance = composed(matrices, place, raised);
  statistics.inverse_covariance = composed(matrices, place, raised.cwiseInverse());
  statistics.structure_class = structureClass(eigenvalues);
  statistics.weight = statistics.mean_confidence * weighting.alpha(statistics.structure_class);
  return true;
}

}  // namespace

StructureClass structureClass(const Eigen::Vector3d& eigenvalues) {
  Eigen::Vector3d sigma = eigenvalues.cwiseMax(0.0).cwiseSqrt();
  std::sort(sigma.data(), sigma.data() + 3);
  const double linear = sigma[2] - sigma[1];
  const double planar = sigma[1] - sigma[0];
  const double volumetric = sigma[0];
  if (linear >= planar && linear >= volumetric) return StructureClass::LINEAR;
  return planar >= volumetric ? StructureClass::PLANAR : StructureClass::VOLUMETRIC;
}

void internal::appendVoxelStatistics(const MergedVoxel* voxels, std::size_t count, const VoxelWeighting& weighting,
                                     const LevelPlan& level, double metres_per_step,
                                     std::vector<VoxelStatistics>& statistics) {
  const auto least_count = static_cast<std::uint64_t>(weighting.min_points_per_voxel);
  SymmetricMatrices matrices;
  std::array<bool, SymmetricMatrices::kMost> unbounded;
  for (std::size_t next = 0; next < count;) {
    const std::size_t first = statistics.size();
    std::size_t matrix_count = 0;
    for (; next < count && matrix_count < SymmetricMatrices::kMost; ++next) {
      const MergedVoxel& voxel = voxels[next];
      if (voxel.sums.count < least_count || (voxel.scan_count != 0 && voxel.scan_count < level.min_scans)) continue;
      VoxelStatistics& known = statistics.emplace_back();
      known.voxel = voxel.voxel;
      known.point_count = voxel.sums.count;
      unbounded[matrix_count] = level.unbounded_ground && voxel.ground_share > 0.5;
      known.mean_from_centre = meanAndCovariance(voxel.sums, metres_per_step, matrices, matrix_count++);
      known.mean_confidence = voxel.mean_confidence;
      known.ground_share = voxel.ground_share;
    }
    findEigenvectors(matrices, matrix_count);
    std::size_t kept = first;
    for (std::size_t i = 0; i < matrix_count; ++i) {
      if (!complete(matrices, i, weighting, level.min_spread_m, unbounded[i], statistics[first + i])) continue;
      if (kept != first + i) statistics[kept] = statistics[first + i];
      ++kept;
    }
    statistics.resize(kept);
  }
}

std::optional<VoxelStatistics> voxelStatistics(const VoxelCoordinate& voxel, const VoxelSums& sums,
                                               double mean_confidence, const VoxelWeighting& weighting,
                                               double metres_per_step) {
  const MergedVoxel merged{voxel, sums, mean_confidence, 0.0, 0};
  std::vector<VoxelStatistics> statistics;
  appendVoxelStatistics(&merged, 1, weighting, {}, metres_per_step, statistics);
  if (statistics.empty()) return std::nullopt;
  return statistics.front();
}

}  // namespace saw_ndt
