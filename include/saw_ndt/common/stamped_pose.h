#pragma once

#include <Eigen/Geometry>

namespace saw_ndt {

/// Where the body (the LiDAR, unless stated otherwise) was at a moment.
struct StampedPose {
  double stamp_s = 0.0;
  Eigen::Isometry3d T_map_body = Eigen::Isometry3d::Identity();
};

}  // namespace saw_ndt
