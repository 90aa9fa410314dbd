#include "map/level_plan.h"

#include <algorithm>
#include <cmath>

namespace saw_ndt::internal {
namespace {

// Edge of the largest voxels in those of the map: the integers of their sums have room for 33 million points each.
constexpr double kMostVoxels = 16.0;
// Of the coarse ones: room for 8 million.
constexpr int kMostCoarseVoxels = 32;

int factorTo(double edge_m, double resolution_m) {
  return static_cast<int>(std::clamp(std::round(edge_m / resolution_m), 1.0, kMostVoxels));
}

}  // namespace

TargetPlan planTarget(const MapOrigin& origin, const VoxelWeighting& weighting) {
  const VoxelSizes& sizes = weighting.sizes;
  const double resolution_m = origin.resolution_m;
  const auto level = [&](int factor) {
    return LevelPlan{factor, factor * resolution_m, 0, 0.0, weighting.unbounded_ground};
  };
  TargetPlan plan;
  plan.levels.push_back(level(factorTo(sizes.finest_m, resolution_m)));
  while (2.0 * plan.levels.back().resolution_m <= sizes.coarsest_m && 2 * plan.levels.back().factor <= kMostVoxels) {
    // A map of one scan has no better.
    plan.levels.back().min_scans =
        static_cast<std::uint32_t>(std::min(static_cast<std::uint64_t>(sizes.min_scans), origin.scan_count));
    LevelPlan larger = level(2 * plan.levels.back().factor);
    larger.min_spread_m = sizes.min_spread * larger.resolution_m;
    plan.levels.push_back(larger);
  }
  if (weighting.coarse_factor > 1) {
    plan.coarse = level(std::min(plan.levels.front().factor * weighting.coarse_factor, kMostCoarseVoxels));
    // Far from a pose, planes without end would pull from everywhere.
    plan.coarse->unbounded_ground = false;
  }
  return plan;
}

}  // namespace saw_ndt::internal
