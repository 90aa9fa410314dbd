#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/labels.h"

namespace saw_ndt {

/// Integer coordinates of a voxel: it spans [coordinate, coordinate + 1) * resolution along each axis.
using VoxelCoordinate = Eigen::Vector3i;

/// Steps of the fixed-point grid across one voxel: positions within a voxel are kept to resolution / kStepsPerVoxel
/// (15 micrometres in a 1 m voxel; the rounding is at most half a step, 7.6 micrometres, far below a LiDAR's noise).
constexpr std::int32_t kStepsPerVoxel = 65536;

/// A position as voxel coordinates and whole steps from that voxel's centre.
struct QuantizedPosition {
  VoxelCoordinate voxel;
  std::array<std::int32_t, 3> steps;  ///< each in [-kStepsPerVoxel / 2, kStepsPerVoxel / 2]
};

/// Quantizes `position_m`; false where it is not finite or too far out for 32-bit voxel coordinates.
inline bool quantize(const Eigen::Vector3d& position_m, double inverse_resolution, QuantizedPosition& quantized) {
  constexpr double kLimit = 2147483000.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double scaled = position_m[axis] * inverse_resolution;
    if (!(std::abs(scaled) < kLimit)) return false;
    const double whole = std::floor(scaled);
    quantized.voxel[axis] = static_cast<int>(whole);
    quantized.steps[axis] = static_cast<std::int32_t>((scaled - whole) * kStepsPerVoxel + 0.5) - kStepsPerVoxel / 2;
  }
  return true;
}

/// Count, sums and products of the points of one voxel, in steps from the voxel's centre. Integers make addition exact
/// and associative: neither the order of points, nor threads, nor merging parts changes a bit. Room for kMostPoints.
struct SAW_NDT_EXPORT VoxelSums {
  static constexpr std::uint64_t kMostPoints = std::uint64_t{1} << 33;

  std::uint64_t count = 0;
  std::array<std::int64_t, 3> sum{};
  std::array<std::int64_t, 6> product{};  ///< xx xy xz yy yz zz

  void add(const std::array<std::int32_t, 3>& steps) {
    const std::int64_t x = steps[0], y = steps[1], z = steps[2];
    ++count;
    sum[0] += x;
    sum[1] += y;
    sum[2] += z;
    product[0] += x * x;
    product[1] += x * y;
    product[2] += x * z;
    product[3] += y * y;
    product[4] += y * z;
    product[5] += z * z;
  }

  VoxelSums& operator+=(const VoxelSums& other);

  /// The sums of the same points about a centre `shift` steps away from this one in the negative direction: every
  /// point's steps grow by `shift`. Exact.
  VoxelSums shifted(const std::array<std::int64_t, 3>& shift) const;

  friend bool operator==(const VoxelSums& a, const VoxelSums& b) {
    return a.count == b.count && a.sum == b.sum && a.product == b.product;
  }
};

/// The sums of those points of one voxel that carry one label. A voxel keeps its labels apart, so that one map serves
/// every choice of confidences, and of which labels take part at all.
struct LabelledVoxelSums {
  VoxelCoordinate voxel;
  StructuralLabel label = StructuralLabel::NON_GROUND;
  VoxelSums sums;
  std::uint32_t scan_count = 0;  ///< scans that these points come from; 0: not known, as in older map files
};

}  // namespace saw_ndt
