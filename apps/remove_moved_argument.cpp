#include "remove_moved_argument.h"

#include <iostream>
#include <utility>

namespace saw_ndt {

void RemoveMovedArgument::addTo(AppOptions& app) {
  app.addOption("max-hit-share", &options_.max_hit_share, "SHARE",
                "a voxel goes where fewer than this share of the scans that saw onto or through it hit it, 0 to 0.5");
}

void RemoveMovedArgument::check() const {
  checkedUsage([&] { options_.check(); });
}

WeightedVoxelMap RemoveMovedArgument::remove(WeightedVoxelMap map, const std::string& name,
                                             const std::function<void(MovedVoxels&)>& add_scans) const {
  check();
  MovedVoxels moved(std::move(map), options_);
  add_scans(moved);
  WeightedVoxelMap remaining = moved.remaining();
  std::cout << name << ": removed what moved, " << moved.map().origin().point_count - remaining.origin().point_count
            << " of " << moved.map().origin().point_count << " points\n";
  return remaining;
}

}  // namespace saw_ndt
