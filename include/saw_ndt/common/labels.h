#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace saw_ndt {

/// Structure of a LiDAR point as range-image segmentation sees it; stored in the `label` field of pcl::PointXYZL.
enum class StructuralLabel : std::uint8_t {
  NOISE = 0,       ///< part of no ground and of no component that is large enough
  GROUND = 1,      ///< driveable or walkable surface
  NON_GROUND = 2,  ///< part of a component that is large enough
};

/// How many values StructuralLabel has.
constexpr int kStructuralLabelCount = 3;

/// The label that a `label` field's value stands for. @throws std::invalid_argument where it stands for none
inline StructuralLabel structuralLabelFromValue(std::uint32_t value) {
  if (value >= kStructuralLabelCount) {
    throw std::invalid_argument("label = " + std::to_string(value) +
                                ": must be 0 (noise), 1 (ground) or 2 (non-ground)");
  }
  return static_cast<StructuralLabel>(value);
}

/// The labels of a scan's points, wherever they lie in memory: nothing is copied, nothing is owned. Threads may share
/// it while nobody writes to what it views.
struct LabelView {
  LabelView() = default;
  /// One label after the other.
  explicit LabelView(const std::vector<StructuralLabel>& labels)
      : first(reinterpret_cast<const std::uint8_t*>(labels.data())) {}

  /// The label of the first point, a value of StructuralLabel; null: no labels are known.
  const std::uint8_t* first = nullptr;
  /// Bytes from one label to the next.
  std::size_t stride = 1;
  /// Whether there are labels, be it of no point at all.
  bool known() const { return first != nullptr; }
};

}  // namespace saw_ndt
