#include "saw_ndt/map/weighted_map_builder.h"

#include <cmath>
#include <stdexcept>

#include "saw_ndt/common/error.h"

namespace saw_ndt {

WeightedMapBuilder::WeightedMapBuilder(double resolution_m) {
  checkOption(resolution_m > 0.0 && std::isfinite(resolution_m), "resolution_m", resolution_m, "positive");
  origin_.resolution_m = resolution_m;
}

void WeightedMapBuilder::requireKind(bool labelled) {
  if (origin_.scan_count == 0) {
    origin_.labelled = labelled;
  } else if (origin_.labelled != labelled) {
    throw std::invalid_argument("a map holds either labelled or unlabelled clouds, not both");
  }
}

void WeightedMapBuilder::startCloud(const Eigen::Isometry3d& T_map_cloud, bool labelled) {
  if (!T_map_cloud.matrix().allFinite()) throw std::invalid_argument("T_map_cloud is not finite");
  requireKind(labelled);
  ++origin_.scan_count;
}

void WeightedMapBuilder::merge(const WeightedMapBuilder& other) {
  checkOption(other.origin_.resolution_m == origin_.resolution_m, "resolution_m", other.origin_.resolution_m,
              "that of the builder merged into");
  if (other.origin_.scan_count == 0) return;
  requireKind(other.origin_.labelled);
  table_.add(other.table_);
  origin_.scan_count += other.origin_.scan_count;
  origin_.point_count += other.origin_.point_count;
}

WeightedVoxelMap WeightedMapBuilder::build(const VoxelWeighting& weighting) const {
  return {origin_, table_.entries(), weighting};
}

}  // namespace saw_ndt
