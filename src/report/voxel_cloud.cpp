#include "report/voxel_cloud.h"

namespace saw_ndt {

pcl::PointCloud<VoxelPoint> voxelCloud(const WeightedVoxelMap& map) {
  const NdtLevel& level = map.fine();
  pcl::PointCloud<VoxelPoint> cloud;
  cloud.resize(level.size());
  for (std::size_t i = 0; i < level.size(); ++i) {
    const VoxelStatistics voxel = level.voxel(i);
    cloud[i].getVector4fMap() = voxel.mean(level.resolution()).cast<float>().homogeneous();
    cloud[i].structure_class = static_cast<float>(voxel.structure_class);
    cloud[i].weight = static_cast<float>(voxel.weight);
  }
  std::vector<std::uint64_t> most_points(level.size(), 0);
  for (const LabelledVoxelSums& entry : map.entries()) {
    const std::int32_t found = level.index().find(entry.voxel);
    if (found == VoxelIndex::kNone || map.weighting().confidence.of(entry.label) <= 0.0) continue;
    const auto i = static_cast<std::size_t>(found);
    // The labels of a voxel come in ascending order.
    if (entry.sums.count < most_points[i]) continue;
    most_points[i] = entry.sums.count;
    cloud[i].label = static_cast<std::uint32_t>(entry.label);
  }
  return cloud;
}

}  // namespace saw_ndt
