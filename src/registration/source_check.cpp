#include "registration/source_check.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

namespace saw_ndt::internal {
namespace {

// A motion may have turned points that were within reach along every axis.
constexpr float kFarthestTurned_m = 2.0F * kFarthest_m;

// Numbers without their sign are in the order of their bits, and what is no number is beyond all. Integers, so that
// compilers make vector instructions of it.
bool allWithinReach(const std::vector<float>& values) {
  constexpr std::uint32_t kWithoutSign = 0x7fffffff;
  std::uint32_t farthest = 0;
  std::memcpy(&farthest, &kFarthestTurned_m, sizeof(farthest));
  std::uint32_t borrowed = 0;
  for (const float value : values) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof(bits));
    borrowed |= farthest - (bits & kWithoutSign);
  }
  return borrowed <= kWithoutSign;
}

bool allLabels(const std::vector<std::uint8_t>& labels) {
  std::uint8_t greatest = 0;
  for (const std::uint8_t label : labels) greatest = std::max(greatest, label);
  return greatest < kStructuralLabelCount;
}

}  // namespace

void requireRegistrable(const SourcePoints& source) {
  const std::size_t size = source.x.size();
  if (source.y.size() != size || source.z.size() != size || source.label.size() != size) {
    throw std::invalid_argument("source: " + std::to_string(size) + " x, " + std::to_string(source.y.size()) + " y, " +
                                std::to_string(source.z.size()) + " z and " + std::to_string(source.label.size()) +
                                " labels");
  }
  if (!allWithinReach(source.x) || !allWithinReach(source.y) || !allWithinReach(source.z)) {
    throw std::invalid_argument("source: a point is not finite, or out of reach");
  }
  if (!allLabels(source.label)) throw std::invalid_argument("source: a label is no StructuralLabel");
}

}  // namespace saw_ndt::internal
