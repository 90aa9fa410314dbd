#include "map/quantized_cell.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace saw_ndt::internal {
namespace {

constexpr double kMeanSteps = 65536.0;
constexpr double kRootSteps = 32767.0;
constexpr double kConfidenceSteps = 65535.0;
constexpr double kShareSteps = 255.0;

template <typename Integer>
Integer rounded(double value, double least, double greatest) {
  return static_cast<Integer>(std::clamp(std::round(value), least, greatest));
}

// The upper triangle R with R^T R = matrix, row after row; rows of directions without curvature are zero.
std::array<double, 6> rootOf(const Eigen::Matrix3d& matrix) {
  constexpr double kNothing = 1e-12;
  const double least = kNothing * matrix.trace();
  std::array<double, 6> root{};
  Eigen::Matrix3d rest = matrix;
  int k = 0;
  for (int i = 0; i < 3; ++i) {
    const double pivot = rest(i, i);
    Eigen::RowVector3d row = Eigen::RowVector3d::Zero();
    if (pivot > least) row = rest.row(i) / std::sqrt(pivot);
    for (int j = i; j < 3; ++j) root[static_cast<std::size_t>(k++)] = row[j];
    rest -= row.transpose() * row;
  }
  return root;
}

}  // namespace

QuantizedCell quantized(const VoxelStatistics& statistics, double resolution_m) {
  QuantizedCell cell{};
  for (int axis = 0; axis < 3; ++axis) {
    const double from_corner = statistics.mean_from_centre[axis] / resolution_m + 0.5;
    cell.mean[axis] = rounded<std::uint16_t>(from_corner * kMeanSteps - 0.5, 0.0, kMeanSteps - 1.0);
  }
  const std::array<double, 6> root = rootOf(statistics.inverse_covariance);
  double greatest = 0.0;
  for (const double element : root) greatest = std::max(greatest, std::abs(element));
  cell.greatest_root = static_cast<float>(greatest);
  for (std::size_t i = 0; i < root.size() && greatest > 0.0; ++i) {
    cell.root[i] = rounded<std::int16_t>(root[i] / greatest * kRootSteps, -kRootSteps, kRootSteps);
  }
  cell.mean_confidence = rounded<std::uint16_t>(statistics.mean_confidence * kConfidenceSteps, 0.0, kConfidenceSteps);
  cell.ground_share = rounded<std::uint8_t>(statistics.ground_share * kShareSteps, 0.0, kShareSteps);
  cell.structure_class = static_cast<std::uint8_t>(statistics.structure_class);
  return cell;
}

PackedNdtCell dequantized(const QuantizedCell& cell, double resolution_m, const VoxelWeighting& weighting) {
  PackedNdtCell packed{};
  const auto step_m = static_cast<float>(resolution_m / kMeanSteps);
  for (int axis = 0; axis < 3; ++axis) {
    packed.mean_from_centre[axis] = (static_cast<float>(cell.mean[axis]) - 32767.5F) * step_m;
  }
  const float scale = cell.greatest_root / static_cast<float>(kRootSteps);
  float r[6];
  for (std::size_t i = 0; i < 6; ++i) r[i] = static_cast<float>(cell.root[i]) * scale;
  packed.inverse_covariance[0] = r[0] * r[0];
  packed.inverse_covariance[1] = r[0] * r[1];
  packed.inverse_covariance[2] = r[0] * r[2];
  packed.inverse_covariance[3] = r[1] * r[1] + r[3] * r[3];
  packed.inverse_covariance[4] = r[1] * r[2] + r[3] * r[4];
  packed.inverse_covariance[5] = r[2] * r[2] + r[4] * r[4] + r[5] * r[5];
  const double mean_confidence = cell.mean_confidence / kConfidenceSteps;
  packed.mean_confidence = static_cast<float>(mean_confidence);
  packed.weight =
      static_cast<float>(mean_confidence * weighting.alpha(static_cast<StructureClass>(cell.structure_class)));
  packed.ground_share = static_cast<float>(cell.ground_share / kShareSteps);
  return packed;
}

bool isValid(const QuantizedCell& cell) {
  // Points of a voxel are at least a step of its sums apart, and no curvature may overflow.
  constexpr float kGreatestRoot = 1e12F;
  return cell.greatest_root >= 0.0F && cell.greatest_root <= kGreatestRoot && cell.structure_class >= 1 &&
         cell.structure_class <= 3;
}

}  // namespace saw_ndt::internal
