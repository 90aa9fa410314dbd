#include "saw_ndt/map/weighted_map_builder.h"

#include <pcl/point_types.h>

#include <cmath>
#include <stdexcept>
#include <string>

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

template <typename PointT>
void WeightedMapBuilder::addCloud(const pcl::PointCloud<PointT>& cloud, const Eigen::Isometry3d& T_map_cloud) {
  constexpr bool kLabelled = pcl::traits::has_label<PointT>::value;
  if (!T_map_cloud.matrix().allFinite()) throw std::invalid_argument("T_map_cloud is not finite");
  if constexpr (kLabelled) {
    for (const PointT& point : cloud) {
      if (point.label >= kStructuralLabelCount) {
        throw std::invalid_argument("label = " + std::to_string(point.label) +
                                    ": must be 0 (noise), 1 (ground) or 2 (non-ground)");
      }
    }
  }
  requireKind(kLabelled);
  const double inverse_resolution = 1.0 / origin_.resolution_m;
  QuantizedPosition position;
  for (const PointT& point : cloud) {
    const Eigen::Vector3d p_map = T_map_cloud * Eigen::Vector3d(point.x, point.y, point.z);
    if (!quantize(p_map, inverse_resolution, position)) continue;
    StructuralLabel label = StructuralLabel::NonGround;
    if constexpr (kLabelled) label = static_cast<StructuralLabel>(point.label);
    table_.at(position.voxel, label).add(position.steps);
    ++origin_.point_count;
  }
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

template void WeightedMapBuilder::addCloud(const pcl::PointCloud<pcl::PointXYZ>&, const Eigen::Isometry3d&);
template void WeightedMapBuilder::addCloud(const pcl::PointCloud<pcl::PointXYZI>&, const Eigen::Isometry3d&);
template void WeightedMapBuilder::addCloud(const pcl::PointCloud<pcl::PointXYZL>&, const Eigen::Isometry3d&);

}  // namespace saw_ndt
