#include "drives/reference_motion.h"

#include <algorithm>
#include <cmath>

namespace saw_ndt::internal {
namespace {

constexpr double kSameTime_s = 1e-3;
constexpr double kLongestInterval_s = 1.0;

std::optional<BodyMotion> motionFrom(const StampedPose& a, const StampedPose& b) {
  const double interval_s = b.stamp_s - a.stamp_s;
  if (interval_s <= kSameTime_s || interval_s > kLongestInterval_s) return std::nullopt;
  return motionBetween(a.T_map_body.inverse() * b.T_map_body, interval_s);
}

}  // namespace

std::optional<ScanMotion> motionAt(const std::vector<StampedPose>& T_map_lidar, double stamp_s) {
  const auto here =
      std::lower_bound(T_map_lidar.begin(), T_map_lidar.end(), stamp_s - kSameTime_s,
                       [](const StampedPose& pose, double at_stamp_s) { return pose.stamp_s < at_stamp_s; });
  if (here == T_map_lidar.end() || here->stamp_s > stamp_s + kSameTime_s) return std::nullopt;
  std::optional<BodyMotion> before, after;
  if (here != T_map_lidar.begin()) before = motionFrom(*(here - 1), *here);
  if (here + 1 != T_map_lidar.end()) after = motionFrom(*here, *(here + 1));
  if (!before && !after) return std::nullopt;
  return ScanMotion{before ? *before : *after, after ? *after : *before};
}

}  // namespace saw_ndt::internal
