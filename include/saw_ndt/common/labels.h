#pragma once

#include <cstdint>

namespace saw_ndt {

/// Structure of a LiDAR point as range-image segmentation sees it; stored in the `label` field of pcl::PointXYZL.
enum class StructuralLabel : std::uint32_t {
  Noise = 0,      ///< part of no ground and of no component that is large enough
  Ground = 1,     ///< driveable or walkable surface
  NonGround = 2,  ///< part of a component that is large enough
};

/// How many values StructuralLabel has.
constexpr int kStructuralLabelCount = 3;

}  // namespace saw_ndt
