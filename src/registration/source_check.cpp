#include "registration/source_check.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace saw_ndt::internal {
namespace {

// A motion may have turned points that were within reach along every axis.
constexpr float kFarthestTurned_m = 2.0F * kFarthest_m;

// Without a branch, so that it takes next to no time beside a registration.
bool allWithinReach(const std::vector<float>& values) {
  bool within = true;
  for (const float value : values) within &= std::abs(value) <= kFarthestTurned_m;
  return within;
}

bool allLabels(const std::vector<std::uint8_t>& labels) {
  bool known = true;
  for (const std::uint8_t label : labels) known &= label < kStructuralLabelCount;
  return known;
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
