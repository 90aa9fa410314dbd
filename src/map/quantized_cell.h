#pragma once

#include <cstdint>

#include "map/ndt_level.h"
#include "saw_ndt/map/voxel_statistics.h"

namespace saw_ndt::internal {

/// A voxel of a localization map in 32 bytes, little-endian in the file. Off from the exact one by no more than
///   mean              2^-17 of a voxel along each axis
///   root of the inverse covariance, an upper triangle R with R^T R = C^-1: each element 2^-16 of the largest, so that
///                     no direction of a voxel whose eigenvalues differ by 100 has a curvature that is off by 0.2 %
///   mean confidence   2^-17, and so the weight but for alpha
///   share of ground   1/510
/// All of them are positive semidefinite, whatever the bytes.
struct QuantizedCell {
  std::uint16_t place[3];  ///< in its tile (voxels)
  std::uint16_t mean[3];   ///< from the voxel's least corner, in 2^-16 of its edge
  std::int16_t root[6];    ///< xx xy xz yy yz zz, in 1/32767 of the greatest
  float greatest_root;     ///< greatest element of the root (1/m)
  std::uint16_t mean_confidence;
  std::uint8_t ground_share;
  std::uint8_t structure_class;
};
static_assert(sizeof(QuantizedCell) == 32);

/// All but its place.
QuantizedCell quantized(const VoxelStatistics& statistics, double resolution_m);
/// What matching reads of it.
PackedNdtCell dequantized(const QuantizedCell& cell, double resolution_m, const VoxelWeighting& weighting);
/// Whether a file may hold such a cell.
bool isValid(const QuantizedCell& cell);

}  // namespace saw_ndt::internal
