#include "pose_argument.h"

#include "saw_ndt/common/geometry.h"

namespace saw_ndt {

Eigen::Isometry3d transformOf(const std::vector<double>& xyz_rpy_deg) {
  Vector6d values;
  for (int i = 0; i < 6; ++i) {
    const double value = xyz_rpy_deg.at(static_cast<std::size_t>(i));
    values[i] = i < 3 ? value : radiansFromDegrees(value);
  }
  return transformFromXyzRpy(values);
}

std::vector<double> poseArgumentOf(const Eigen::Isometry3d& T) {
  const Vector6d values = xyzRpyFromTransform(T);
  std::vector<double> xyz_rpy_deg(values.data(), values.data() + 6);
  for (std::size_t i = 3; i < 6; ++i) xyz_rpy_deg[i] = degreesFromRadians(xyz_rpy_deg[i]);
  return xyz_rpy_deg;
}

}  // namespace saw_ndt
