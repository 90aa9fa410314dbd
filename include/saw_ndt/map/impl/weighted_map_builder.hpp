#pragma once

#include "saw_ndt/segmentation/cloud_view.h"

namespace saw_ndt {

template <typename PointT>
void WeightedMapBuilder::addCloud(const pcl::PointCloud<PointT>& cloud, const Eigen::Isometry3d& T_map_cloud,
                                  int threads) {
  const std::uint32_t* labels = nullptr;
  if constexpr (pcl::traits::has_label<PointT>::value) {
    for (const PointT& point : cloud) structuralLabelFromValue(point.label);
    static const std::uint32_t no_label = 0;
    labels = cloud.empty() ? &no_label : &cloud.front().label;
  }
  addPoints(viewOf(cloud), labels, sizeof(PointT) / sizeof(std::uint32_t), T_map_cloud, threads);
}

}  // namespace saw_ndt
