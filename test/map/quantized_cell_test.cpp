#include "map/quantized_cell.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "map_fixtures.h"

namespace saw_ndt {

using namespace internal;

namespace {

// The bounds that QuantizedCell states, for voxels of walls, poles, bushes and ground.
void expectWithinBounds(const VoxelWeighting& weighting, double least_eigenvalue_ratio) {
  constexpr double kResolution_m = 0.5;
  const WeightedVoxelMap map = mapOf(mixedCloud(3, 60000), kResolution_m);
  const std::vector<VoxelStatistics> all = map.statistics(weighting, 1);
  ASSERT_GT(all.size(), 500U);
  for (VoxelStatistics exact : all) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(exact.covariance);
    // Ground without end, as targets may have it.
    if (weighting.unbounded_ground) {
      exact.inverse_covariance =
          solver.eigenvectors() *
          Eigen::Vector3d(1.0, 1e-2 * least_eigenvalue_ratio, least_eigenvalue_ratio).asDiagonal() *
          solver.eigenvectors().transpose() / solver.eigenvalues()[0];
    }
    const PackedNdtCell cell = dequantized(quantized(exact, kResolution_m), kResolution_m, weighting);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(cell.mean_from_centre[axis], exact.mean_from_centre[axis], kResolution_m * (0x1p-17 + 1e-7));
    }
    const Eigen::Matrix3d curvature = inverseCovarianceOf(cell);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d direction = solver.eigenvectors().col(k);
      const double expected = direction.dot(exact.inverse_covariance * direction);
      // Of a root whose least singular value is so much of the greatest, each of up to three elements off by 2^-16.
      EXPECT_NEAR(direction.dot(curvature * direction), expected,
                  expected * 2.0 * std::sqrt(6.0) * 0x1p-16 / std::sqrt(1e-2 * least_eigenvalue_ratio));
    }
    EXPECT_GE(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(curvature).eigenvalues()[0], -1e-6 * curvature.trace());
    EXPECT_NEAR(cell.mean_confidence, exact.mean_confidence, 0x1p-17 + 1e-7);
    EXPECT_NEAR(cell.weight, exact.weight, weighting.alpha(exact.structure_class) * 0x1p-17 + 1e-6);
    EXPECT_NEAR(cell.ground_share, exact.ground_share, 1.0 / 510.0 + 1e-6);
  }
}

TEST(QuantizedCell, IsNoFurtherOffThanStated) { expectWithinBounds({}, 1.0); }

TEST(QuantizedCell, HoldsGroundWithoutEnd) {
  VoxelWeighting weighting;
  weighting.unbounded_ground = true;
  expectWithinBounds(weighting, 1e-2);
}

TEST(QuantizedCell, IsPositiveSemidefiniteWhateverItsBytes) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> element(-32768, 32767);
  for (int i = 0; i < 1000; ++i) {
    QuantizedCell cell{};
    for (auto& root : cell.root) root = static_cast<std::int16_t>(element(random));
    cell.greatest_root = 50.0F;
    cell.structure_class = 1;
    ASSERT_TRUE(isValid(cell));
    const Eigen::Matrix3d curvature = inverseCovarianceOf(dequantized(cell, 0.5, {}));
    EXPECT_GE(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(curvature).eigenvalues()[0], -1e-6 * curvature.trace());
  }
}

TEST(QuantizedCell, ThatCannotBeIsTold) {
  QuantizedCell cell{};
  cell.structure_class = 2;
  EXPECT_TRUE(isValid(cell));
  for (const float root :
       {-1.0F, 1e30F, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    cell.greatest_root = root;
    EXPECT_FALSE(isValid(cell)) << root;
  }
  cell.greatest_root = 1.0F;
  for (const int structure_class : {0, 4, 255}) {
    cell.structure_class = static_cast<std::uint8_t>(structure_class);
    EXPECT_FALSE(isValid(cell)) << structure_class;
  }
}

}  // namespace
}  // namespace saw_ndt
