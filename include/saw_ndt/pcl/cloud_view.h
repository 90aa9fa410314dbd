#pragma once

#include <pcl/point_cloud.h>
#include <pcl/type_traits.h>

#include "saw_ndt/common/labels.h"
#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/map/weighted_map_builder.h"

namespace saw_ndt {

/// A view of a cloud whose points have y and z behind x, as all of PCL's do; without ring numbers.
template <typename PointT>
ScanView viewOf(const pcl::PointCloud<PointT>& cloud) {
  static_assert(sizeof(PointT) % sizeof(float) == 0, "points must be a whole number of floats apart");
  ScanView view;
  view.xyz = cloud.empty() ? nullptr : &cloud.front().x;
  view.stride = sizeof(PointT) / sizeof(float);
  view.size = cloud.size();
  view.width = cloud.width;
  view.height = cloud.height;
  return view;
}

/// The labels of a cloud of points with a `label` field; none where the type has no such field.
/// @throws std::invalid_argument for a value that is no StructuralLabel
template <typename PointT>
LabelView labelsOf(const pcl::PointCloud<PointT>& cloud) {
  LabelView labels;
  if constexpr (pcl::traits::has_label<PointT>::value) {
    for (const PointT& point : cloud) structuralLabelFromValue(point.label);
    static const std::uint8_t no_label = 0;
    // The low byte of a label is its value.
    labels.first = cloud.empty() ? &no_label : reinterpret_cast<const std::uint8_t*>(&cloud.front().label);
    labels.stride = sizeof(PointT);
  }
  return labels;
}

/// Adds the finite points of a cloud to a map, under the labels of their `label` field where they have one.
/// @param T_map_cloud  pose of the cloud's frame in the map frame
/// @throws std::invalid_argument as labelsOf() and WeightedMapBuilder::addScan()
template <typename PointT>
void addCloud(WeightedMapBuilder& builder, const pcl::PointCloud<PointT>& cloud, const Eigen::Isometry3d& T_map_cloud,
              int threads = 1) {
  builder.addScan(viewOf(cloud), labelsOf(cloud), T_map_cloud, threads);
}

}  // namespace saw_ndt
