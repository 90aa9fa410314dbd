#include "registration/ndt_objective.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "common/executor.h"
#include "registration/voxel_pairs.h"

namespace saw_ndt::internal {
namespace {

constexpr std::size_t kPointsPerBlock = 1024;

// The sums of one point over its pairs: a force and two symmetric matrices (xx xy xz yy yz zz).
struct PointSums {
  std::size_t pairs = 0;
  double score = 0.0;
  double gx = 0.0, gy = 0.0, gz = 0.0;
  std::array<double, 6> curvature{};
  std::array<double, 6> radial{};
};

// Adds J^T M J for the symmetric M, with J = [I, -[r]x].
void addProjected(const std::array<double, 6>& m, const Eigen::Vector3d& r, Matrix6d& sum) {
  Eigen::Matrix3d M;
  M << m[0], m[1], m[2], m[1], m[3], m[4], m[2], m[4], m[5];
  // Column k of -M [r]x is M (e_k x r).
  Eigen::Matrix3d turned;
  turned.col(0) = M.col(2) * r.y() - M.col(1) * r.z();
  turned.col(1) = M.col(0) * r.z() - M.col(2) * r.x();
  turned.col(2) = M.col(1) * r.x() - M.col(0) * r.y();
  sum.topLeftCorner<3, 3>() += M;
  sum.topRightCorner<3, 3>() += turned;
  // -[r]x^T applied from the left: row k is (e_k x r)^T times `turned`.
  sum.row(3).tail<3>() += turned.row(2) * r.y() - turned.row(1) * r.z();
  sum.row(4).tail<3>() += turned.row(0) * r.z() - turned.row(2) * r.x();
  sum.row(5).tail<3>() += turned.row(1) * r.x() - turned.row(0) * r.y();
}

}  // namespace

double compatibility(double source_confidence, double voxel_mean_confidence, const PairWeighting& weighting) {
  const double range = std::abs(weighting.confidence.non_ground - weighting.confidence.ground);
  const double difference = std::abs(source_confidence - voxel_mean_confidence);
  const double share = range > 0.0 ? std::min(1.0, difference / range) : 0.0;
  return 1.0 - (1.0 - weighting.mismatch_penalty) * share;
}

NdtObjective::NdtObjective(const internal::NdtLevel& level, NeighborhoodSearchMethod method,
                           const ScoreParameters& score, const PairWeighting& weighting)
    : level_(level), method_(method), score_(score), weighting_(weighting) {
  if (!level.hasDoubleCells()) {
    throw std::invalid_argument(
        "Arithmetic::DOUBLE needs a target that was made with CellPrecision::SINGLE_AND_DOUBLE");
  }
}

template <NeighborhoodSearchMethod method, bool weighted>
void NdtObjective::evaluateBlock(const SourcePoints& source, const Eigen::Isometry3d& T_map_source, std::size_t first,
                                 std::size_t last, std::size_t stride, NdtDerivatives& sums) const {
  const double half_d2 = 0.5 * score_.d2;
  const Eigen::Matrix3d R = T_map_source.linear();
  const std::array<double, kStructuralLabelCount> confidence_of_label = {
      weighting_.confidence.noise, weighting_.confidence.ground, weighting_.confidence.non_ground};
  VoxelPairs voxel_pairs(level_, T_map_source);

  for (std::size_t i = first; i < last; i += stride) {
    const Eigen::Vector3d r = R * Eigen::Vector3d(source.x[i], source.y[i], source.z[i]);
    const double source_confidence = weighted ? confidence_of_label[source.label[i]] : 1.0;
    PointSums point;
    voxel_pairs.forEach<method>(r, [&](const internal::NdtCell& cell, double qx, double qy, double qz) {
      ++point.pairs;
      const WhitenedOffset u(cell, qx, qy, qz);
      const double exponent = half_d2 * u.squared_mahalanobis;
      if (exponent > kLargestExponent) return;
      double score = score_.amplitude * std::exp(-exponent);
      if (weighted) {
        score *= source_confidence * cell.weight * compatibility(source_confidence, cell.mean_confidence, weighting_);
      }
      point.score += score;
      const double k = score * score_.d2;
      point.gx -= k * u.x;
      point.gy -= k * u.y;
      point.gz -= k * u.z;
      for (std::size_t j = 0; j < 6; ++j) point.curvature[j] += k * cell.inverse_covariance[j];
      const double k2 = k * score_.d2;
      point.radial[0] += k2 * u.x * u.x;
      point.radial[1] += k2 * u.x * u.y;
      point.radial[2] += k2 * u.x * u.z;
      point.radial[3] += k2 * u.y * u.y;
      point.radial[4] += k2 * u.y * u.z;
      point.radial[5] += k2 * u.z * u.z;
    });
    if (point.pairs == 0) continue;
    sums.pair_count += point.pairs;
    sums.score += point.score;
    const Eigen::Vector3d g(point.gx, point.gy, point.gz);
    sums.force += g;
    sums.moment += g * r.transpose();
    addProjected(point.curvature, r, sums.curvature);
    addProjected(point.radial, r, sums.radial_curvature);
  }
}

NdtDerivatives NdtObjective::evaluate(const SourcePoints& source, const Eigen::Isometry3d& T_map_source, int threads,
                                      Workspace& workspace, std::size_t stride) const {
  NdtDerivatives total;
  if (!VoxelPairs::reachable(level_, T_map_source)) return total;

  using Block = void (NdtObjective::*)(const SourcePoints&, const Eigen::Isometry3d&, std::size_t, std::size_t,
                                       std::size_t, NdtDerivatives&) const;
  Block block = nullptr;
  const bool weighted = weighting_.enabled;
  switch (method_) {
    case NeighborhoodSearchMethod::RADIUS:
      block = weighted ? &NdtObjective::evaluateBlock<NeighborhoodSearchMethod::RADIUS, true>
                       : &NdtObjective::evaluateBlock<NeighborhoodSearchMethod::RADIUS, false>;
      break;
    case NeighborhoodSearchMethod::DIRECT26:
      block = weighted ? &NdtObjective::evaluateBlock<NeighborhoodSearchMethod::DIRECT26, true>
                       : &NdtObjective::evaluateBlock<NeighborhoodSearchMethod::DIRECT26, false>;
      break;
    case NeighborhoodSearchMethod::DIRECT7:
      block = weighted ? &NdtObjective::evaluateBlock<NeighborhoodSearchMethod::DIRECT7, true>
                       : &NdtObjective::evaluateBlock<NeighborhoodSearchMethod::DIRECT7, false>;
      break;
    case NeighborhoodSearchMethod::DIRECT3:
      block = weighted ? &NdtObjective::evaluateBlock<NeighborhoodSearchMethod::DIRECT3, true>
                       : &NdtObjective::evaluateBlock<NeighborhoodSearchMethod::DIRECT3, false>;
      break;
    case NeighborhoodSearchMethod::DIRECT1:
      block = weighted ? &NdtObjective::evaluateBlock<NeighborhoodSearchMethod::DIRECT1, true>
                       : &NdtObjective::evaluateBlock<NeighborhoodSearchMethod::DIRECT1, false>;
      break;
  }

  const std::size_t block_size = kPointsPerBlock * stride;
  const std::size_t block_count = (source.size() + block_size - 1) / block_size;
  workspace.blocks.assign(block_count, NdtDerivatives());
  internal::forEachChunk(threads, block_count, [&](std::size_t b, int) {
    const std::size_t first = b * block_size;
    (this->*block)(source, T_map_source, first, std::min(first + block_size, source.size()), stride,
                   workspace.blocks[b]);
  });
  for (const NdtDerivatives& sums : workspace.blocks) total += sums;
  for (Matrix6d* matrix : {&total.curvature, &total.radial_curvature}) {
    matrix->bottomLeftCorner<3, 3>() = matrix->topRightCorner<3, 3>().transpose();
  }
  return total;
}

}  // namespace saw_ndt::internal
