#include "localization/source_voxel_loops.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "localization/source_voxel_loops.cpp"
#include "common/vector_dispatch.h"

HWY_BEFORE_NAMESPACE();
namespace saw_ndt::internal {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int kAxisBits = 20;
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

// The bits of a voxel's number along one axis; `near` becomes false where it is too far or not a number.
template <class D, class V, class M>
HWY_INLINE hn::Vec<hn::RebindToUnsigned<D>> keyOf(D d, V voxel, M& near) {
  near = hn::And(near, hn::Lt(hn::Abs(voxel), hn::Set(d, kFarthestVoxel)));
  const auto number = hn::ConvertTo(hn::RebindToSigned<D>(), hn::IfThenElseZero(near, voxel));
  const hn::RebindToUnsigned<D> du;
  return hn::And(hn::BitCast(du, number), hn::Set(du, kAxisMask));
}

void findBlockVoxels(std::size_t count, float voxel_size_m, float inverse_size, SourceVoxelBlock& block) {
  const hn::ScalableTag<float> d;
  const hn::RebindToUnsigned<decltype(d)> du;
  const hn::Rebind<std::uint8_t, decltype(d)> d8;
  const auto size = hn::Set(d, voxel_size_m);
  const auto inverse = hn::Set(d, inverse_size);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto x = hn::Load(d, block.x + i);
    const auto y = hn::Load(d, block.y + i);
    const auto z = hn::Load(d, block.z + i);
    const auto voxel_x = hn::Floor(hn::Mul(x, inverse));
    const auto voxel_y = hn::Floor(hn::Mul(y, inverse));
    const auto voxel_z = hn::Floor(hn::Mul(z, inverse));
    auto near = hn::Eq(size, size);
    const auto key_x = keyOf(d, voxel_x, near);
    const auto key_y = keyOf(d, voxel_y, near);
    const auto key_z = keyOf(d, voxel_z, near);
    const auto label = hn::PromoteTo(du, hn::Load(d8, block.label + i));
    const auto low = hn::Or(key_x, hn::ShiftLeft<kAxisBits>(key_y));
    const auto high = hn::Or(hn::ShiftRight<32 - kAxisBits>(key_y), hn::Or(hn::ShiftLeft<2 * kAxisBits - 32>(key_z),
                                                                           hn::ShiftLeft<3 * kAxisBits - 32>(label)));
    const auto too_far = hn::Not(hn::VecFromMask(du, hn::RebindMask(du, near)));
    hn::StoreInterleaved2(hn::Or(low, too_far), hn::Or(high, too_far), du, block.key + 2 * i);
    hn::StoreInterleaved4(hn::Sub(x, hn::Mul(voxel_x, size)), hn::Sub(y, hn::Mul(voxel_y, size)),
                          hn::Sub(z, hn::Mul(voxel_z, size)), hn::Set(d, 1.0F), d, block.offset + 4 * i);
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
  constexpr std::int32_t kBeyond = 32 - kAxisBits;
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
}  // namespace saw_ndt::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saw_ndt::internal {

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

}  // namespace saw_ndt::internal
#endif
