#include "map/symmetric_eigen.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstring>
#include <memory>
#include <random>
#include <vector>

#include "common/instruction_set.h"

namespace saw_ndt {
namespace {

using namespace internal;

using Matrices = std::vector<Eigen::Matrix3d>;

class SymmetricEigen : public testing::TestWithParam<InstructionSet> {
 protected:
  SymmetricEigen() { limitInstructionSet(GetParam()); }
  ~SymmetricEigen() override { limitInstructionSet(InstructionSet::AVX512); }
};

std::unique_ptr<SymmetricMatrices> decomposed(const Matrices& matrices, std::size_t first, std::size_t count) {
  auto batch = std::make_unique<SymmetricMatrices>();
  for (std::size_t m = 0; m < count; ++m) {
    std::size_t k = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) batch->element[k++][m] = matrices[first + m](i, j);
    }
  }
  findEigenvectors(*batch, count);
  return batch;
}

Eigen::Vector3d eigenvaluesOf(const SymmetricMatrices& batch, std::size_t m) {
  return {batch.eigenvalue[0][m], batch.eigenvalue[1][m], batch.eigenvalue[2][m]};
}

Eigen::Matrix3d eigenvectorsOf(const SymmetricMatrices& batch, std::size_t m) {
  Eigen::Matrix3d axes;
  for (int which = 0; which < 3; ++which) {
    for (int axis = 0; axis < 3; ++axis) axes(axis, which) = batch.eigenvector[which][axis][m];
  }
  return axes;
}

// Of every rank, with equal and nearly equal eigenvalues, graded over many decades, turned anyhow, at every scale.
Matrices manyMatrices() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Matrices matrices{Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Ones(),
                    Eigen::Vector3d(3.0, 1.0, 2.0).asDiagonal().toDenseMatrix()};
  const std::vector<Eigen::Vector3d> spectra{{1.0, 1.0, 1.0},     {1.0, 1.0, 0.0},         {1.0, 0.0, 0.0},
                                             {1.0, 1.0, 1e-14},   {1.0, 1.0 + 1e-13, 0.5}, {1.0, 1e-6, 1e-12},
                                             {1.0, 0.3, 0.01},    {1.0, -1.0, 0.25},       {2.0, 2.0, 1.0},
                                             {1.0, 1e-16, 1e-16}, {1.0, 1.0 - 1e-8, 1.0}};
  for (int trial = 0; trial < 500; ++trial) {
    const Eigen::Matrix3d R =
        Eigen::Quaterniond(unit(random), unit(random), unit(random), unit(random)).normalized().toRotationMatrix();
    for (const double scale : {1.0, 1e-12, 1e9, 1e-290, 1e290}) {
      for (const Eigen::Vector3d& spectrum : spectra) {
        const Eigen::Matrix3d matrix = scale * (R * spectrum.asDiagonal() * R.transpose());
        matrices.push_back(0.5 * (matrix + matrix.transpose()));
      }
      const Eigen::Matrix3d any = Eigen::Matrix3d::NullaryExpr([&] { return scale * unit(random); });
      matrices.push_back(any + any.transpose());
    }
  }
  return matrices;
}

TEST_P(SymmetricEigen, AgreesWithEigen) {
  const Matrices matrices = manyMatrices();
  for (std::size_t first = 0; first < matrices.size(); first += SymmetricMatrices::kMost) {
    const std::size_t count = std::min(SymmetricMatrices::kMost, matrices.size() - first);
    const auto batch = decomposed(matrices, first, count);
    for (std::size_t m = 0; m < count; ++m) {
      // At a scale at which squares neither overflow nor vanish.
      const double scale = std::max(matrices[first + m].cwiseAbs().maxCoeff(), 1e-300);
      const Eigen::Matrix3d matrix = matrices[first + m] / scale;
      const Eigen::Vector3d eigenvalues = eigenvaluesOf(*batch, m) / scale;
      const Eigen::Matrix3d axes = eigenvectorsOf(*batch, m);
      ASSERT_LE((axes * axes.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14) << matrix;
      ASSERT_LE((axes * eigenvalues.asDiagonal() * axes.transpose() - matrix).norm(), 1e-14) << matrix;
      Eigen::Vector3d ascending = eigenvalues;
      std::sort(ascending.data(), ascending.data() + 3);
      const Eigen::Vector3d expected = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(matrix).eigenvalues();
      ASSERT_LE((ascending - expected).norm(), 1e-14) << matrix;
    }
  }
}

TEST_P(SymmetricEigen, DoesNotDependOnWhatStandsBesideIt) {
  const Matrices matrices = manyMatrices();
  const auto batch = decomposed(matrices, 100, SymmetricMatrices::kMost);
  for (std::size_t m = 0; m < SymmetricMatrices::kMost; ++m) {
    const auto alone = decomposed(matrices, 100 + m, 1);
    ASSERT_EQ(eigenvaluesOf(*alone, 0), eigenvaluesOf(*batch, m));
    ASSERT_EQ(eigenvectorsOf(*alone, 0), eigenvectorsOf(*batch, m));
  }
}

TEST_P(SymmetricEigen, IsTheSameForEveryInstructionSet) {
  const Matrices matrices = manyMatrices();
  for (std::size_t first = 0; first + SymmetricMatrices::kMost <= 2000; first += SymmetricMatrices::kMost) {
    limitInstructionSet(GetParam());
    const auto batch = decomposed(matrices, first, SymmetricMatrices::kMost);
    limitInstructionSet(InstructionSet::BASELINE);
    const auto expected = decomposed(matrices, first, SymmetricMatrices::kMost);
    for (std::size_t m = 0; m < SymmetricMatrices::kMost; ++m) {
      ASSERT_EQ(eigenvaluesOf(*batch, m), eigenvaluesOf(*expected, m));
      ASSERT_EQ(eigenvectorsOf(*batch, m), eigenvectorsOf(*expected, m));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(EveryInstructionSet, SymmetricEigen,
                         testing::Values(InstructionSet::BASELINE, InstructionSet::SSE4, InstructionSet::AVX2,
                                         InstructionSet::AVX512),
                         [](const auto& set) { return toString(set.param); });

}  // namespace
}  // namespace saw_ndt
