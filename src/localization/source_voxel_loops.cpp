#include "localization/source_voxel_loops.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "localization/source_voxel_loops.cpp"
#include "common/vector_dispatch.h"

HWY_BEFORE_NAMESPACE();
namespace saw_ndt {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::uint32_t kAxisBits = 20;
constexpr std::uint32_t kAxisMask = (1U << kAxisBits) - 1;

void transformBlock(std::size_t count, const RigidTransformRows& transform, SourceVoxelBlock& block) {
  const RigidTransformRows t = transform;
  float* __restrict x = block.x;
  float* __restrict y = block.y;
  float* __restrict z = block.z;
  for (std::size_t i = 0; i < count; ++i) {
    const float moved_x = t.row[3] + ((t.row[0] * x[i] + t.row[1] * y[i]) + t.row[2] * z[i]);
    const float moved_y = t.row[7] + ((t.row[4] * x[i] + t.row[5] * y[i]) + t.row[6] * z[i]);
    const float moved_z = t.row[11] + ((t.row[8] * x[i] + t.row[9] * y[i]) + t.row[10] * z[i]);
    x[i] = moved_x;
    y[i] = moved_y;
    z[i] = moved_z;
  }
}

// The greatest whole number that is not above `value`; kFarthestVoxel or more where it is too far or not a number.
HWY_INLINE float floorOf(float value) {
  const float near = __builtin_fabsf(value) <= kFarthestVoxel ? value : kFarthestVoxel;
  const auto truncated = static_cast<float>(static_cast<std::int32_t>(near));
  return truncated - (truncated > near ? 1.0F : 0.0F);
}

HWY_INLINE void keysOf(std::size_t count, float size, float inverse_size, const float* __restrict x,
                       const float* __restrict y, const float* __restrict z, const std::uint8_t* __restrict label,
                       std::uint32_t* __restrict low, std::uint32_t* __restrict high, float* __restrict offset_x,
                       float* __restrict offset_y, float* __restrict offset_z) {
  for (std::size_t i = 0; i < count; ++i) {
    const float voxel_x = floorOf(x[i] * inverse_size);
    const float voxel_y = floorOf(y[i] * inverse_size);
    const float voxel_z = floorOf(z[i] * inverse_size);
    const bool near = (__builtin_fabsf(voxel_x) < kFarthestVoxel) & (__builtin_fabsf(voxel_y) < kFarthestVoxel) &
                      (__builtin_fabsf(voxel_z) < kFarthestVoxel);
    const auto key_x = static_cast<std::uint32_t>(static_cast<std::int32_t>(voxel_x)) & kAxisMask;
    const auto key_y = static_cast<std::uint32_t>(static_cast<std::int32_t>(voxel_y)) & kAxisMask;
    const auto key_z = static_cast<std::uint32_t>(static_cast<std::int32_t>(voxel_z)) & kAxisMask;
    const std::uint32_t low_key = key_x | key_y << kAxisBits;
    const std::uint32_t high_key =
        key_y >> (32 - kAxisBits) | key_z << (2 * kAxisBits - 32) | std::uint32_t{label[i]} << (3 * kAxisBits - 32);
    low[i] = near ? low_key : ~0U;
    high[i] = near ? high_key : ~0U;
    offset_x[i] = x[i] - voxel_x * size;
    offset_y[i] = y[i] - voxel_y * size;
    offset_z[i] = z[i] - voxel_z * size;
  }
}

void findBlockVoxels(std::size_t count, float size, float inverse_size, SourceVoxelBlock& block) {
  constexpr std::size_t kSize = SourceVoxelBlock::kSize;
  HWY_ALIGN std::uint32_t low[kSize];
  HWY_ALIGN std::uint32_t high[kSize];
  HWY_ALIGN float offset_x[kSize];
  HWY_ALIGN float offset_y[kSize];
  HWY_ALIGN float offset_z[kSize];
  keysOf(count, size, inverse_size, block.x, block.y, block.z, block.label, low, high, offset_x, offset_y, offset_z);
  for (std::size_t i = 0; i < count; ++i) block.key[i] = std::uint64_t{high[i]} << 32 | low[i];
  const hn::ScalableTag<float> d;
  const auto one = hn::Set(d, 1.0F);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    hn::StoreInterleaved4(hn::Load(d, offset_x + i), hn::Load(d, offset_y + i), hn::Load(d, offset_z + i), one, d,
                          block.offset + 4 * i);
  }
}

void addBlockOffsets(std::size_t count, const float* __restrict offset, const std::uint16_t* __restrict ordinal,
                     const std::uint32_t* __restrict number, float* __restrict offset_sums) {
  for (std::size_t i = 0; i < count; ++i) {
    float* const sum = offset_sums + 4 * std::size_t{number[ordinal[i]]};
    for (std::size_t k = 0; k < 4; ++k) sum[k] += offset[4 * i + k];
  }
}

// The voxel along one axis, whose sign is in the highest of its bits.
HWY_INLINE float voxelOf(std::uint32_t key, float size) {
  constexpr std::int32_t kBeyond = 32 - static_cast<std::int32_t>(kAxisBits);
  return static_cast<float>(static_cast<std::int32_t>(key << kBeyond) >> kBeyond) * size;
}

void findBlockCentroids(std::size_t count, float size, const std::uint64_t* __restrict key,
                        const float* __restrict offset_sums, float* __restrict x, float* __restrict y,
                        float* __restrict z, std::uint8_t* __restrict label) {
  for (std::size_t i = 0; i < count; ++i) {
    const float points = offset_sums[4 * i + 3];
    x[i] = voxelOf(static_cast<std::uint32_t>(key[i]), size) + offset_sums[4 * i] / points;
    y[i] = voxelOf(static_cast<std::uint32_t>(key[i] >> kAxisBits), size) + offset_sums[4 * i + 1] / points;
    z[i] = voxelOf(static_cast<std::uint32_t>(key[i] >> 2 * kAxisBits), size) + offset_sums[4 * i + 2] / points;
    label[i] = static_cast<std::uint8_t>(key[i] >> 3 * kAxisBits);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace saw_ndt
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saw_ndt {

HWY_EXPORT(transformBlock);
HWY_EXPORT(findBlockVoxels);
HWY_EXPORT(addBlockOffsets);
HWY_EXPORT(findBlockCentroids);

void transformPoints(std::size_t count, const RigidTransformRows& transform, SourceVoxelBlock& block) {
  SAW_NDT_DISPATCH(transformBlock)(count, transform, block);
}

void findVoxels(std::size_t count, float voxel_size_m, float inverse_size, SourceVoxelBlock& block) {
  SAW_NDT_DISPATCH(findBlockVoxels)(count, voxel_size_m, inverse_size, block);
}

void addOffsets(std::size_t count, const float* offset, const std::uint16_t* ordinal, const std::uint32_t* number,
                float* offset_sums) {
  SAW_NDT_DISPATCH(addBlockOffsets)(count, offset, ordinal, number, offset_sums);
}

void findCentroids(std::size_t count, float voxel_size_m, const std::uint64_t* key, const float* offset_sums, float* x,
                   float* y, float* z, std::uint8_t* label) {
  SAW_NDT_DISPATCH(findBlockCentroids)(count, voxel_size_m, key, offset_sums, x, y, z, label);
}

}  // namespace saw_ndt
#endif
