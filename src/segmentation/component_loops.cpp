#include "segmentation/component_loops.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "segmentation/component_loops.cpp"
#include "common/vector_dispatch.h"

HWY_BEFORE_NAMESPACE();
namespace saw_ndt::internal {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

void withoutGround(std::size_t count, const float* __restrict range, const std::uint8_t* __restrict ground,
                   float* __restrict obstacle_range) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t is_ground = ground[i];
    obstacle_range[i] = is_ground != 0 ? 0.0F : range[i];
  }
}

// Where first and second are ranges: false where the nearer is no return, with range 0.
HWY_INLINE bool connected(float first, float second, float ratio) {
  const float nearer = first < second ? first : second;
  const float farther = first < second ? second : first;
  return nearer * ratio > farther;
}

HWY_INLINE void link(std::size_t count, float ratio_along, float ratio_across, const float* __restrict range,
                     const float* __restrict above, std::uint8_t* __restrict links) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t active = range[i + 1] > 0.0F ? kActive : 0;
    const std::int32_t along = connected(range[i + 1], range[i], ratio_along) ? kLinkedBefore : 0;
    const std::int32_t across = connected(range[i + 1], above[i], ratio_across) ? kLinkedAbove : 0;
    links[i] = static_cast<std::uint8_t>(active + along + across);
  }
}

void linkRow(std::size_t count, const ConnectionRatios& ratios, const float* range, const float* above,
             std::uint8_t* links) {
  link(count, ratios.along, ratios.across, range, above, links);
}

#if HWY_TARGET == HWY_SCALAR
// The bits `flag` of eight bytes.
HWY_INLINE std::uint8_t bitsOfEight(std::uint64_t bytes, std::uint8_t flag) {
  const std::uint64_t one_each = (bytes / flag) & 0x0101010101010101U;
  return static_cast<std::uint8_t>(one_each * 0x0102040810204080U >> 56);
}
#endif

void packBits(std::size_t words, const std::uint8_t* links, std::uint64_t* active, std::uint64_t* linked_before,
              std::uint64_t* linked_above) {
  auto* const active_bytes = reinterpret_cast<std::uint8_t*>(active);
  auto* const before_bytes = reinterpret_cast<std::uint8_t*>(linked_before);
  auto* const above_bytes = reinterpret_cast<std::uint8_t*>(linked_above);
#if HWY_TARGET == HWY_SCALAR
  for (std::size_t i = 0; i < 8 * words; ++i) {
    std::uint64_t of_pixels;
    __builtin_memcpy(&of_pixels, links + 8 * i, sizeof(of_pixels));
    active_bytes[i] = bitsOfEight(of_pixels, kActive);
    before_bytes[i] = bitsOfEight(of_pixels, kLinkedBefore);
    above_bytes[i] = bitsOfEight(of_pixels, kLinkedAbove);
  }
#else
  const hn::ScalableTag<std::uint8_t> d;
  for (std::size_t i = 0; i < 64 * words; i += hn::Lanes(d)) {
    const auto of_pixels = hn::LoadU(d, links + i);
    hn::StoreMaskBits(d, hn::TestBit(of_pixels, hn::Set(d, kActive)), active_bytes + i / 8);
    hn::StoreMaskBits(d, hn::TestBit(of_pixels, hn::Set(d, kLinkedBefore)), before_bytes + i / 8);
    hn::StoreMaskBits(d, hn::TestBit(of_pixels, hn::Set(d, kLinkedAbove)), above_bytes + i / 8);
  }
#endif
}

std::size_t columnsOfWords(std::size_t words, const std::uint64_t* bits, std::uint16_t added, std::uint16_t* columns) {
  std::size_t count = 0;
  for (std::size_t word = 0; word < words; ++word) {
    for (std::uint64_t rest = bits[word]; rest != 0; rest &= rest - 1) {
      columns[count++] =
          static_cast<std::uint16_t>(64 * word + static_cast<std::size_t>(__builtin_ctzll(rest)) + added);
    }
  }
  return count;
}

// The number of the run that holds the pixel of the lowest of `bits`.
HWY_INLINE std::int32_t runAt(const RowBits& row, std::size_t word, std::uint64_t bits) {
  const std::uint64_t up_to_lowest = bits ^ (bits - 1);
  return row.runs_before[word] + __builtin_popcountll(row.starts[word] & up_to_lowest) - 1;
}

std::size_t pairsOfRows(std::size_t words, const RowBits& row, const RowBits& above, const std::uint64_t* linked_above,
                        RunPair* pairs) {
  std::size_t count = 0;
  std::uint64_t linked_before = 0;  // the last bit of the word before
  for (std::size_t word = 0; word < words; ++word) {
    const std::uint64_t linked = linked_above[word];
    // Where the pixels before these are connected too, and in both rows to these, the pair has been written.
    const std::uint64_t written = (linked << 1 | linked_before) & row.joined[word] & above.joined[word];
    linked_before = linked >> 63;
    for (std::uint64_t rest = linked & ~written; rest != 0; rest &= rest - 1) {
      pairs[count++] = {runAt(above, word, rest), runAt(row, word, rest)};
    }
  }
  return count;
}

void labelRow(std::size_t count, const std::uint8_t* ground, const std::uint64_t* kept, StructuralLabel* labels) {
  static_assert(static_cast<int>(StructuralLabel::GROUND) == 1 && static_cast<int>(StructuralLabel::NOISE) == 0,
                "what tells of ground is a label");
  auto* const values = reinterpret_cast<std::uint8_t*>(labels);
  constexpr auto kNonGround = static_cast<std::uint8_t>(StructuralLabel::NON_GROUND);
  std::size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  const hn::ScalableTag<std::uint8_t> d;
  const auto* const kept_bytes = reinterpret_cast<const std::uint8_t*>(kept);
  for (; i + hn::Lanes(d) <= count; i += hn::Lanes(d)) {
    const auto is_kept = hn::LoadMaskBits(d, kept_bytes + i / 8);
    hn::StoreU(hn::IfThenElse(is_kept, hn::Set(d, kNonGround), hn::LoadU(d, ground + i)), d, values + i);
  }
#endif
  for (; i < count; ++i) values[i] = (kept[i / 64] >> i % 64 & 1) != 0 ? kNonGround : ground[i];
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace saw_ndt::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saw_ndt::internal {

HWY_EXPORT(withoutGround);
HWY_EXPORT(linkRow);
HWY_EXPORT(packBits);
HWY_EXPORT(columnsOfWords);
HWY_EXPORT(pairsOfRows);
HWY_EXPORT(labelRow);

void takeOutGround(std::size_t count, const float* range, const std::uint8_t* ground, float* obstacle_range) {
  SAW_NDT_DISPATCH(withoutGround)(count, range, ground, obstacle_range);
}

void linkPixels(std::size_t count, const ConnectionRatios& ratios, const float* range, const float* above,
                std::uint8_t* links) {
  SAW_NDT_DISPATCH(linkRow)(count, ratios, range, above, links);
}

void bitsOfLinks(std::size_t words, const std::uint8_t* links, std::uint64_t* active, std::uint64_t* linked_before,
                 std::uint64_t* linked_above) {
  SAW_NDT_DISPATCH(packBits)(words, links, active, linked_before, linked_above);
}

std::size_t columnsOfBits(std::size_t words, const std::uint64_t* bits, std::uint16_t added, std::uint16_t* columns) {
  return SAW_NDT_DISPATCH(columnsOfWords)(words, bits, added, columns);
}

std::size_t pairsOfRuns(std::size_t words, const RowBits& row, const RowBits& above, const std::uint64_t* linked_above,
                        RunPair* pairs) {
  return SAW_NDT_DISPATCH(pairsOfRows)(words, row, above, linked_above, pairs);
}

void labelPixels(std::size_t count, const std::uint8_t* ground, const std::uint64_t* kept, StructuralLabel* labels) {
  SAW_NDT_DISPATCH(labelRow)(count, ground, kept, labels);
}

}  // namespace saw_ndt::internal
#endif
