#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt::internal {

/// Levels of a target: at most those of 1, 2, 4, 8 and 16 voxels of a map.
constexpr std::size_t kMostLevels = 5;

/// One size of voxels that a target has, and which of them.
struct LevelPlan {
  int factor = 1;                 ///< edge in voxels of the map
  double resolution_m = 1.0;      ///< edge
  std::uint32_t min_scans = 0;    ///< a voxel that fewer scans met, where that is known, is left out
  double min_spread_m = 0.0;      ///< so is one whose points spread less along the second of their principal axes
  bool unbounded_ground = false;  ///< see VoxelWeighting
};

struct TargetPlan {
  std::vector<LevelPlan> levels;    ///< those that match, the finest first
  std::optional<LevelPlan> coarse;  ///< one to start on
};

/// The levels of a target of a map. The weighting has been checked.
TargetPlan planTarget(const MapOrigin& origin, const VoxelWeighting& weighting);

}  // namespace saw_ndt::internal
