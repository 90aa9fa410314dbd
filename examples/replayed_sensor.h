#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "saw_ndt/common/geometry.h"
#include "saw_ndt/io/kitti.h"

/// A point as Velodyne's driver for ROS defines it.
struct VelodynePoint {
  PCL_ADD_POINT4D;
  float intensity;
  std::uint16_t ring;
  float time;
};

/// Stands for a driver in the example: plays scans of a VLP-16, 0.1 s apart, from files.
class ReplayedSensor {
 public:
  explicit ReplayedSensor(std::vector<std::string> files) : files_(std::move(files)) {}

  bool nextArray(std::vector<saw_ndt::LidarPoint>& points, double& stamp_s) {
    if (next_ == files_.size()) return false;
    stamp_s = 0.1 * static_cast<double>(next_);
    points = saw_ndt::readKittiScan(files_[next_++]);
    return true;
  }

  /// The same as a cloud with ring numbers, from the bottom, and times (s) from the start of the scan.
  bool nextCloud(pcl::PointCloud<VelodynePoint>& cloud, double& stamp_s) {
    std::vector<saw_ndt::LidarPoint> points;
    if (!nextArray(points, stamp_s)) return false;
    cloud.clear();
    for (const saw_ndt::LidarPoint& point : points) {
      VelodynePoint& added = cloud.emplace_back();
      added.getVector3fMap() = saw_ndt::positionOf(point);
      added.intensity = point.intensity;
      const double elevation_deg = saw_ndt::degreesFromRadians(std::atan2(point.z, std::hypot(point.x, point.y)));
      added.ring = static_cast<std::uint16_t>(std::lround((15.0 + elevation_deg) / 2.0));
      added.time = static_cast<float>(0.1 * (0.5 + std::atan2(point.y, point.x) / (2.0 * saw_ndt::kPi)));
    }
    return true;
  }

 private:
  std::vector<std::string> files_;
  std::size_t next_ = 0;
};
