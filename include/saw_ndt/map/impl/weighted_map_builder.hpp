#pragma once

namespace saw_ndt {

template <typename PointT>
void WeightedMapBuilder::addCloud(const pcl::PointCloud<PointT>& cloud, const Eigen::Isometry3d& T_map_cloud) {
  constexpr bool kLabelled = pcl::traits::has_label<PointT>::value;
  if constexpr (kLabelled) {
    for (const PointT& point : cloud) structuralLabelFromValue(point.label);
  }
  startCloud(T_map_cloud, kLabelled);
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
}

}  // namespace saw_ndt
