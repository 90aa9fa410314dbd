#include "report/voxel_cloud.h"

namespace saw_ndt {

std::vector<StructuralLabel> voxelLabels(const WeightedVoxelMap& map, const std::vector<VoxelStatistics>& voxels,
                                         const ConfidenceOptions& confidence) {
  std::vector<StructuralLabel> labels;
  labels.reserve(voxels.size());
  auto entry = map.entries().begin();
  for (const VoxelStatistics& voxel : voxels) {
    // Voxels and entries are in the same order, the labels of a voxel in ascending order.
    while (entry->voxel != voxel.voxel) ++entry;
    std::uint64_t most_points = 0;
    StructuralLabel label = StructuralLabel::NOISE;
    for (; entry != map.entries().end() && entry->voxel == voxel.voxel; ++entry) {
      if (confidence.of(entry->label) <= 0.0 || entry->sums.count < most_points) continue;
      most_points = entry->sums.count;
      label = entry->label;
    }
    labels.push_back(label);
  }
  return labels;
}

pcl::PointCloud<VoxelPoint> voxelCloud(const WeightedVoxelMap& map, const VoxelWeighting& weighting) {
  const std::vector<VoxelStatistics> voxels = map.statistics(weighting);
  const std::vector<StructuralLabel> labels = voxelLabels(map, voxels, weighting.confidence);
  pcl::PointCloud<VoxelPoint> cloud;
  cloud.resize(voxels.size());
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const VoxelStatistics& voxel = voxels[i];
    cloud[i].getVector4fMap() = voxel.mean(map.resolution()).cast<float>().homogeneous();
    cloud[i].label = static_cast<std::uint32_t>(labels[i]);
    cloud[i].structure_class = static_cast<float>(voxel.structure_class);
    cloud[i].weight = static_cast<float>(voxel.weight);
  }
  return cloud;
}

}  // namespace saw_ndt
