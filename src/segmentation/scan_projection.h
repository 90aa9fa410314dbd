#pragma once

#include <Eigen/Geometry>
#include <limits>

#include "saw_ndt/segmentation/segmentation_options.h"

namespace saw_ndt::internal {

/// Which points of a scan count, and which way is up.
struct ScanProjection {
  /// Every return of an upright sensor.
  ScanProjection() = default;
  /// As options that have been checked say.
  explicit ScanProjection(const SegmentationOptions& options);

  /// From the LiDAR frame to a level one: Ry(pitch) Rx(roll).
  Eigen::Matrix3f R_level_lidar = Eigen::Matrix3f::Identity();
  float min_range_m = 0.0F;
  float max_range_m = std::numeric_limits<float>::max();
  Eigen::AlignedBox3f vehicle;  ///< of the vehicle itself, in the LiDAR frame; empty: there is none

  /// Whether the top beam is the one that looks down.
  bool isUpsideDown() const { return R_level_lidar(2, 2) < 0.0F; }
  /// Whether the axis of the sensor leans so far that its columns do not lead outward over the ground.
  bool liesOnItsSide() const;
};

}  // namespace saw_ndt::internal
