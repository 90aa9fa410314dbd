#pragma once

#include <pcl/point_cloud.h>

#include "saw_ndt/segmentation/scan_view.h"

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

}  // namespace saw_ndt
