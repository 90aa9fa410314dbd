#include "common/pose_interpolation.h"

#include <algorithm>

namespace saw_ndt::internal {

Eigen::Isometry3d interpolatedPose(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to, double share) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = from.translation() + share * (to.translation() - from.translation());
  pose.linear() =
      Eigen::Quaterniond(from.linear()).slerp(share, Eigen::Quaterniond(to.linear())).normalized().toRotationMatrix();
  return pose;
}

std::optional<Eigen::Isometry3d> poseAt(const std::vector<StampedPose>& trajectory, double stamp_s,
                                        double longest_gap_s) {
  constexpr double kSameTime_s = 1e-3;
  if (trajectory.empty() || stamp_s < trajectory.front().stamp_s - kSameTime_s ||
      stamp_s > trajectory.back().stamp_s + kSameTime_s) {
    return std::nullopt;
  }
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), stamp_s,
                                      [](const StampedPose& pose, double stamp) { return pose.stamp_s < stamp; });
  if (after == trajectory.end()) return trajectory.back().T_map_body;
  if (after == trajectory.begin() || after->stamp_s == stamp_s) return after->T_map_body;
  const StampedPose& before = *(after - 1);
  const double interval_s = after->stamp_s - before.stamp_s;
  if (interval_s > longest_gap_s) return std::nullopt;
  return interpolatedPose(before.T_map_body, after->T_map_body, (stamp_s - before.stamp_s) / interval_s);
}

}  // namespace saw_ndt::internal
