#pragma once

#include <cstddef>

namespace saw_ndt::internal {

/// Symmetric 3 x 3 matrices side by side, and what is found of them.
struct SymmetricMatrices {
  static constexpr std::size_t kMost = 64;

  alignas(64) double element[6][kMost];  ///< xx xy xz yy yz zz
  alignas(64) double eigenvalue[3][kMost];
  alignas(64) double eigenvector[3][3][kMost];  ///< of unit length: [which][x y z]
};

/// Finds the eigenvalues and eigenvectors of the first `count` matrices, in no order, by cyclic Jacobi rotations for
/// the instruction set in use. An error is a few units in the last place of a matrix's greatest element. What is found
/// of a matrix does not depend on those beside it. Elements must be finite; they are left as they are.
void findEigenvectors(SymmetricMatrices& matrices, std::size_t count);

}  // namespace saw_ndt::internal
