#pragma once

#include <cstddef>
#include <cstdint>

namespace saw_ndt::internal {

/// Points and what is known of their voxels, one array a coordinate.
struct SourceVoxelBlock {
  static constexpr std::size_t kSize = 256;

  alignas(64) float x[kSize];  ///< m, at last in the frame of the source
  alignas(64) float y[kSize];
  alignas(64) float z[kSize];
  alignas(64) std::uint8_t label[kSize];     ///< values of StructuralLabel
  alignas(64) std::uint32_t key[2 * kSize];  ///< voxel and label, lower half first; see keyAt() and kNoVoxel
  alignas(64) float offset[4 * kSize];       ///< from the voxel's lower corner (x, y, z), and 1, point after point

  std::uint64_t keyAt(std::size_t i) const { return std::uint64_t{key[2 * i + 1]} << 32 | key[2 * i]; }
};

/// The key of a point that is not finite or too far away. Others hold, from the lowest bit on, 20 bits of x, y and z of
/// the voxel and 2 bits of label.
constexpr std::uint64_t kNoVoxel = ~std::uint64_t{0};

/// Voxels are numbered below this along each axis.
constexpr float kFarthestVoxel = 524288.0F;

/// The upper three rows of a rigid transform, row-major.
struct RigidTransformRows {
  float row[12];
};

// The same bits for every instruction set.

/// Moves the first `count` points.
void transformPoints(std::size_t count, const RigidTransformRows& transform, SourceVoxelBlock& block);

/// Finds the voxels of the first `count` points.
void findVoxels(std::size_t count, float voxel_size_m, float inverse_size, SourceVoxelBlock& block);

/// Adds the offset of each point j to that of voxel number[ordinal[j]].
void addOffsets(std::size_t count, const float* offset, const std::uint16_t* ordinal, const std::uint32_t* number,
                float* offset_sums);

/// The centroid of each voxel (m) and its label.
void findCentroids(std::size_t count, float voxel_size_m, const std::uint64_t* key, const float* offset_sums, float* x,
                   float* y, float* z, std::uint8_t* label);

}  // namespace saw_ndt::internal
