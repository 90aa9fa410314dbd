#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "saw_ndt/common/labels.h"

namespace saw_ndt {

/// What is farther away along any axis (m) is no measurement, and its square overflows single precision.
constexpr float kFarthest_m = 1.0e9F;

/// Whether a point can be registered: finite, and no farther away than kFarthest_m.
inline bool isWithinReach(float x, float y, float z) {
  return std::abs(x) <= kFarthest_m && std::abs(y) <= kFarthest_m && std::abs(z) <= kFarthest_m;
}

/// The finite points that are to be registered, one array a coordinate (m, source frame), and their labels.
struct SourcePoints {
  std::vector<float> x, y, z;
  std::vector<std::uint8_t> label;  ///< values of StructuralLabel
  bool labelled = false;            ///< false: no labels are known, `label` holds NonGround throughout

  std::size_t size() const { return x.size(); }
  bool empty() const { return x.empty(); }
  void clear() {
    x.clear();
    y.clear();
    z.clear();
    label.clear();
    labelled = false;
  }
  void reserve(std::size_t count) {
    x.reserve(count);
    y.reserve(count);
    z.reserve(count);
    label.reserve(count);
  }
  void add(float px, float py, float pz, StructuralLabel point_label) {
    x.push_back(px);
    y.push_back(py);
    z.push_back(pz);
    label.push_back(static_cast<std::uint8_t>(point_label));
  }
};

}  // namespace saw_ndt
