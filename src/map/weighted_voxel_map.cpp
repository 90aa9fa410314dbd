#include "saw_ndt/map/weighted_voxel_map.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "map/map_file.h"
#include "map/map_order.h"
#include "map/map_tile.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {

WeightedVoxelMap::WeightedVoxelMap(const MapOrigin& origin, std::vector<LabelledVoxelSums> entries,
                                   const VoxelWeighting& weighting, int threads)
    : origin_(origin), weighting_(weighting), entries_(std::move(entries)) {
  checkOption(origin.resolution_m > 0.0 && std::isfinite(origin.resolution_m), "resolution_m", origin.resolution_m,
              "positive");
  weighting_.check();
  if (!std::is_sorted(entries_.begin(), entries_.end(), inMapOrder)) sortIntoMapOrder(entries_);
  const auto not_ascending = [](const LabelledVoxelSums& a, const LabelledVoxelSums& b) { return !inMapOrder(a, b); };
  if (std::adjacent_find(entries_.begin(), entries_.end(), not_ascending) != entries_.end()) {
    throw std::invalid_argument("entries: a voxel and label is given twice");
  }
  fine_ = NdtLevel::fromSums(entries_, origin.resolution_m, 1, weighting_, threads);
  if (weighting_.coarse_factor > 1) {
    coarse_ = NdtLevel::fromSums(entries_, origin.resolution_m, weighting_.coarse_factor, weighting_, threads);
  }
}

void WeightedVoxelMap::save(const std::string& path) const { writeMapFile(path, origin_, entries_); }

WeightedVoxelMap WeightedVoxelMap::load(const std::string& path, const VoxelWeighting& weighting, int threads) {
  MapFileContent content = readMapFile(path);
  return {content.origin, std::move(content.entries), weighting, threads};
}

}  // namespace saw_ndt
