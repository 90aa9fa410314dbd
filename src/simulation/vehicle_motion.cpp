#include "simulation/vehicle_motion.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "saw_ndt/common/geometry.h"

namespace saw_ndt {
namespace {

// A time just a scan off may be rounded to just beyond it.
constexpr double kStampTolerance_s = 1e-6;

[[noreturn]] void refuse(double stamp_s, const std::string& reason) {
  std::ostringstream message;
  message << "stamp_s = " << stamp_s << ": " << reason;
  throw std::invalid_argument(message.str());
}

}  // namespace

Eigen::Isometry3d VehicleMotion::poseAt(double stamp_s) const {
  if (stamps_s.size() < 2) refuse(stamp_s, "must lie in a motion of two scans or more");
  if (stamps_s.size() != T_scene_lidar.size()) refuse(stamp_s, "the motion has not one stamp a pose");
  const auto after = std::upper_bound(stamps_s.begin() + 1, stamps_s.end() - 1, stamp_s);
  const auto next = static_cast<std::size_t>(after - stamps_s.begin());
  const double interval_s = stamps_s[next] - stamps_s[next - 1];
  const double elapsed_s = stamp_s - stamps_s[next - 1];
  if (!(interval_s > 0.0)) refuse(stamp_s, "the stamps around it do not increase");
  if (!(elapsed_s >= -interval_s - kStampTolerance_s && elapsed_s <= 2.0 * interval_s + kStampTolerance_s)) {
    refuse(stamp_s, "must be no more than a scan before the first or after the last stamp");
  }

  const Eigen::Isometry3d& T_scene_before = T_scene_lidar[next - 1];
  const Eigen::Isometry3d T_before_next = T_scene_before.inverse() * T_scene_lidar[next];
  const double share = elapsed_s / interval_s;
  const Eigen::Vector3d turned = rotationVector(T_before_next.linear());
  const Eigen::Vector3d driven = meanRotation(turned).inverse() * T_before_next.translation();
  Eigen::Isometry3d T_before_now = Eigen::Isometry3d::Identity();
  T_before_now.linear() = rotationFromVector(share * turned);
  T_before_now.translation() = meanRotation(share * turned) * driven * share;
  return T_scene_before * T_before_now;
}

VehicleMotion VehicleMotion::withMounting(const Eigen::Matrix3d& R_vehicle_lidar) const {
  VehicleMotion result = *this;
  for (Eigen::Isometry3d& T : result.T_scene_lidar) T.rotate(R_vehicle_lidar);
  return result;
}

}  // namespace saw_ndt
