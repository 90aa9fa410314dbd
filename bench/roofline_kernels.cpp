#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/roofline_kernels.cpp"
#include "roofline_kernels.h"

#include "common/vector_dispatch.h"

HWY_BEFORE_NAMESPACE();
namespace saw_ndt {

using namespace internal;
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_EMU128
// What Highway has for the baseline is one lane or an emulation in memory; the compiler's vectors are the real ones.
using Vector = float __attribute__((vector_size(16)));
constexpr std::size_t kLanes = 4;
Vector broadcast(float value) { return Vector{value, value, value, value}; }
Vector load(const float* values) { return Vector{values[0], values[1], values[2], values[3]}; }
Vector gather(const float* table, const std::int32_t* indices) {
  return Vector{table[indices[0]], table[indices[1]], table[indices[2]], table[indices[3]]};
}
Vector plus(Vector a, Vector b) { return a + b; }
Vector multipliedPlus(Vector a, Vector factor, Vector term) { return a * factor + term; }
float sumOf(Vector a) { return a[0] + a[1] + a[2] + a[3]; }
#else
namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::ScalableTag<float>;
using Vector = hn::Vec<Floats>;
constexpr std::size_t kLanes = HWY_LANES(float);
HWY_INLINE Vector broadcast(float value) { return hn::Set(Floats(), value); }
HWY_INLINE Vector load(const float* values) { return hn::LoadU(Floats(), values); }
HWY_INLINE Vector gather(const float* table, const std::int32_t* indices) {
  return hn::GatherIndex(Floats(), table, hn::LoadU(hn::RebindToSigned<Floats>(), indices));
}
HWY_INLINE Vector plus(Vector a, Vector b) { return hn::Add(a, b); }
HWY_INLINE Vector multipliedPlus(Vector a, Vector factor, Vector term) { return hn::MulAdd(a, factor, term); }
HWY_INLINE float sumOf(Vector a) { return hn::GetLane(hn::SumOfLanes(Floats(), a)); }
#endif

float total(Vector a, Vector b, Vector c, Vector d) { return sumOf(plus(plus(a, b), plus(c, d))); }

// As many chains as keep two units busy that take four to six cycles, within 16 registers.
float multiplyAddImpl(std::size_t rounds, double& operations) {
  const Vector factor = broadcast(0.999f), term = broadcast(0.001f);
  // No two alike, or the compiler makes one of them.
  Vector a0 = broadcast(0.0f), a1 = broadcast(0.1f), a2 = broadcast(0.2f), a3 = broadcast(0.3f);
  Vector a4 = broadcast(0.4f), a5 = broadcast(0.5f), a6 = broadcast(0.6f), a7 = broadcast(0.7f);
  Vector a8 = broadcast(0.8f), a9 = broadcast(0.9f), a10 = broadcast(1.0f), a11 = broadcast(1.1f);
  for (std::size_t round = 0; round < rounds; ++round) {
    a0 = multipliedPlus(a0, factor, term);
    a1 = multipliedPlus(a1, factor, term);
    a2 = multipliedPlus(a2, factor, term);
    a3 = multipliedPlus(a3, factor, term);
    a4 = multipliedPlus(a4, factor, term);
    a5 = multipliedPlus(a5, factor, term);
    a6 = multipliedPlus(a6, factor, term);
    a7 = multipliedPlus(a7, factor, term);
    a8 = multipliedPlus(a8, factor, term);
    a9 = multipliedPlus(a9, factor, term);
    a10 = multipliedPlus(a10, factor, term);
    a11 = multipliedPlus(a11, factor, term);
  }
  operations = 2.0 * 12.0 * static_cast<double>(rounds) * static_cast<double>(kLanes);
  return total(a0, a1, a2, a3) + total(a4, a5, a6, a7) + total(a8, a9, a10, a11);
}

float readValuesImpl(const float* values, std::size_t count) {
  Vector a0 = broadcast(0.0f), a1 = a0, a2 = a0, a3 = a0, a4 = a0, a5 = a0, a6 = a0, a7 = a0;
  for (std::size_t i = 0; i < count; i += 8 * kLanes) {
    a0 = plus(a0, load(values + i));
    a1 = plus(a1, load(values + i + kLanes));
    a2 = plus(a2, load(values + i + 2 * kLanes));
    a3 = plus(a3, load(values + i + 3 * kLanes));
    a4 = plus(a4, load(values + i + 4 * kLanes));
    a5 = plus(a5, load(values + i + 5 * kLanes));
    a6 = plus(a6, load(values + i + 6 * kLanes));
    a7 = plus(a7, load(values + i + 7 * kLanes));
  }
  return total(a0, a1, a2, a3) + total(a4, a5, a6, a7);
}

float gatherValuesImpl(const float* table, const std::int32_t* indices, std::size_t count) {
  Vector a0 = broadcast(0.0f), a1 = a0, a2 = a0, a3 = a0;
  for (std::size_t i = 0; i < count; i += 4 * kLanes) {
    a0 = plus(a0, gather(table, indices + i));
    a1 = plus(a1, gather(table, indices + i + kLanes));
    a2 = plus(a2, gather(table, indices + i + 2 * kLanes));
    a3 = plus(a3, gather(table, indices + i + 3 * kLanes));
  }
  return total(a0, a1, a2, a3);
}

constexpr float kFactors[16] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};

float broadcastValuesImpl(const float* values, std::size_t count) {
  // Lanes that differ, or the compiler adds up one of them.
  const Vector factor = load(kFactors);
  Vector a0 = broadcast(0.0f), a1 = a0, a2 = a0, a3 = a0, a4 = a0, a5 = a0, a6 = a0, a7 = a0;
  for (std::size_t i = 0; i < count; i += 8) {
    a0 = multipliedPlus(broadcast(values[i]), factor, a0);
    a1 = multipliedPlus(broadcast(values[i + 1]), factor, a1);
    a2 = multipliedPlus(broadcast(values[i + 2]), factor, a2);
    a3 = multipliedPlus(broadcast(values[i + 3]), factor, a3);
    a4 = multipliedPlus(broadcast(values[i + 4]), factor, a4);
    a5 = multipliedPlus(broadcast(values[i + 5]), factor, a5);
    a6 = multipliedPlus(broadcast(values[i + 6]), factor, a6);
    a7 = multipliedPlus(broadcast(values[i + 7]), factor, a7);
  }
  return total(a0, a1, a2, a3) + total(a4, a5, a6, a7);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace saw_ndt
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saw_ndt {

HWY_EXPORT(multiplyAddImpl);
HWY_EXPORT(readValuesImpl);
HWY_EXPORT(gatherValuesImpl);
HWY_EXPORT(broadcastValuesImpl);

float multiplyAdd(std::size_t rounds, double& operations) {
  return SAW_NDT_DISPATCH(multiplyAddImpl)(rounds, operations);
}

float readValues(const float* values, std::size_t count) { return SAW_NDT_DISPATCH(readValuesImpl)(values, count); }

float gatherValues(const float* table, const std::int32_t* indices, std::size_t count) {
  return SAW_NDT_DISPATCH(gatherValuesImpl)(table, indices, count);
}

float broadcastValues(const float* values, std::size_t count) {
  return SAW_NDT_DISPATCH(broadcastValuesImpl)(values, count);
}

}  // namespace saw_ndt
#endif
