#include "localization/place_index_loops.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "localization/place_index_loops.cpp"
#include "common/vector_dispatch.h"

HWY_BEFORE_NAMESPACE();
namespace saw_ndt::internal {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Adds two bits to the sum of each place; what is carried counts twice.
template <class V>
HWY_INLINE void addTwo(V a, V b, V& sum, V& carry) {
  const V one_of_them = hn::Xor(a, b);
  carry = hn::Or(hn::And(a, b), hn::And(sum, one_of_them));
  sum = hn::Xor(sum, one_of_them);
}

// Adds a carried bit to one plane of the counts, and leaves what goes on to the next.
template <class V>
HWY_INLINE void addCarry(V& plane, V& carry) {
  const V carried = hn::And(plane, carry);
  plane = hn::Xor(plane, carry);
  carry = carried;
}

bool countBlockMatches(const PlaceTables& tables, const OutlineOffset* offsets, std::size_t count, int first_row,
                       int threshold, const std::uint64_t* allowed, PlaceCounts& counts) {
  const hn::CappedTag<std::uint64_t, kRowsAtOnce> d;
  using V = hn::Vec<decltype(d)>;
  bool any = false;
  for (int lane = 0; lane < kRowsAtOnce; lane += static_cast<int>(hn::Lanes(d))) {
    const auto bits = [&](const OutlineOffset& offset) HWY_ATTR {
      const int row = first_row + lane + offset.rows + kPlaceTileSize;
      const std::uint64_t* const* const words = tables.words[row / kPlaceTileSize] + offset.tile_x;
      const std::ptrdiff_t at = offset.first_word + row % kPlaceTileSize;
      const V left = hn::LoadU(d, words[0] + at);
      const V right = hn::LoadU(d, words[1] + at);
      // In two steps, since a shift by 64 is not defined.
      return hn::Or(hn::ShiftRightSame(left, offset.shift),
                    hn::ShiftLeftSame(hn::ShiftLeft<1>(right), kPlaceTileSize - 1 - offset.shift));
    };
    V plane0 = hn::Zero(d), plane1 = hn::Zero(d), plane2 = hn::Zero(d);
    V plane3 = hn::Zero(d), plane4 = hn::Zero(d), plane5 = hn::Zero(d);
    V plane6 = hn::Zero(d), plane7 = hn::Zero(d), plane8 = hn::Zero(d);
    for (std::size_t i = 0; i < count; i += 8) {
      const OutlineOffset* const eight = offsets + i;
      V two_a, two_b, four_a, four_b, carry;
      addTwo(bits(eight[0]), bits(eight[1]), plane0, two_a);
      addTwo(bits(eight[2]), bits(eight[3]), plane0, two_b);
      addTwo(two_a, two_b, plane1, four_a);
      addTwo(bits(eight[4]), bits(eight[5]), plane0, two_a);
      addTwo(bits(eight[6]), bits(eight[7]), plane0, two_b);
      addTwo(two_a, two_b, plane1, four_b);
      addTwo(four_a, four_b, plane2, carry);
      addCarry(plane3, carry);
      addCarry(plane4, carry);
      addCarry(plane5, carry);
      addCarry(plane6, carry);
      addCarry(plane7, carry);
      addCarry(plane8, carry);
    }
    // From the lowest bit on: a higher one that differs decides.
    V enough = hn::Not(hn::Zero(d));
    const auto decide = [&](int k, V plane) HWY_ATTR {
      enough = ((threshold >> k) & 1) != 0 ? hn::And(enough, plane) : hn::Or(enough, plane);
      hn::StoreU(plane, d, counts.plane[k] + lane);
    };
    decide(0, plane0);
    decide(1, plane1);
    decide(2, plane2);
    decide(3, plane3);
    decide(4, plane4);
    decide(5, plane5);
    decide(6, plane6);
    decide(7, plane7);
    decide(8, plane8);
    enough = hn::And(enough, hn::LoadU(d, allowed + lane));
    hn::StoreU(enough, d, counts.enough + lane);
    any = any || !hn::AllTrue(d, hn::Eq(enough, hn::Zero(d)));
  }
  return any;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace saw_ndt::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saw_ndt::internal {

HWY_EXPORT(countBlockMatches);

bool countMatches(const PlaceTables& tables, const OutlineOffset* offsets, std::size_t count, int first_row,
                  int threshold, const std::uint64_t* allowed, PlaceCounts& counts) {
  return SAW_NDT_DISPATCH(countBlockMatches)(tables, offsets, count, first_row, threshold, allowed, counts);
}

}  // namespace saw_ndt::internal
#endif  // HWY_ONCE
