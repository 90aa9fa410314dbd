#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cmath>
#include <functional>
#include <limits>

#include "saw_ndt/common/geometry.h"
#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/common/sensor_model.h"

namespace saw_ndt {

/// Range in metres that a sensor sees at a row and a column; infinity: no return.
using RangeAt = std::function<double(int row, int column)>;

constexpr double kNoReturn = std::numeric_limits<double>::infinity();
constexpr double kSensorHeight = 1.73;

/// Range in metres to flat ground kSensorHeight below the sensor, up to `farthest`.
inline double rangeToFlatGround(const SensorModel& sensor, int row, double farthest = 60.0) {
  const double sine = std::sin(radiansFromDegrees(sensor.elevations_deg[row]));
  return sine < 0.0 && -kSensorHeight / sine < farthest ? -kSensorHeight / sine : kNoReturn;
}

/// A noiseless organized scan: one point in the middle of each pixel, NaN where there is no return.
inline pcl::PointCloud<pcl::PointXYZ> organizedScan(const SensorModel& sensor, const RangeAt& range_at) {
  pcl::PointCloud<pcl::PointXYZ> cloud;
  cloud.is_dense = false;
  for (int row = 0; row < sensor.rows(); ++row) {
    const double elevation = radiansFromDegrees(sensor.elevations_deg[row]);
    for (int column = 0; column < sensor.columns; ++column) {
      const double azimuth = (column + 0.5) * 2.0 * kPi / sensor.columns;
      double range = range_at(row, column);
      if (!std::isfinite(range)) range = std::numeric_limits<double>::quiet_NaN();
      const double level = range * std::cos(elevation);
      cloud.push_back(pcl::PointXYZ(static_cast<float>(level * std::cos(azimuth)),
                                    static_cast<float>(level * std::sin(azimuth)),
                                    static_cast<float>(range * std::sin(elevation))));
    }
  }
  cloud.width = static_cast<std::uint32_t>(sensor.columns);
  cloud.height = static_cast<std::uint32_t>(sensor.rows());
  return cloud;
}

/// The same points in the same order without those that are NaN, unorganized.
inline pcl::PointCloud<pcl::PointXYZ> ringOrderedScan(const SensorModel& sensor, const RangeAt& range_at) {
  pcl::PointCloud<pcl::PointXYZ> cloud;
  for (const pcl::PointXYZ& point : organizedScan(sensor, range_at)) {
    if (std::isfinite(point.x)) cloud.push_back(point);
  }
  return cloud;
}

inline ScanView viewOf(const pcl::PointCloud<pcl::PointXYZ>& cloud) {
  ScanView view;
  view.xyz = cloud.empty() ? nullptr : &cloud[0].x;
  view.stride = sizeof(pcl::PointXYZ) / sizeof(float);
  view.size = cloud.size();
  view.width = cloud.width;
  view.height = cloud.height;
  return view;
}

}  // namespace saw_ndt
