#include "drives/transform_tree.h"

#include <algorithm>

#include "common/pose_interpolation.h"

namespace saw_ndt::internal {

bool TransformTree::Link::moves() const {
  constexpr double kLeastMotion = 1e-6;
  return std::any_of(poses.begin(), poses.end(), [&](const StampedPose& pose) {
    return !pose.T_map_body.isApprox(poses.front().T_map_body, kLeastMotion);
  });
}

std::optional<Eigen::Isometry3d> TransformTree::Link::at(double stamp_s) const {
  if (poses.empty()) return fixed;
  return poseAt(poses, stamp_s, kLongestPoseGap_s);
}

TransformTree::Link& TransformTree::linkOf(const std::string& parent, const std::string& child) {
  return links_.try_emplace(child, Link{parent, std::nullopt, {}}).first->second;
}

void TransformTree::setFixed(const std::string& parent, const std::string& child,
                             const Eigen::Isometry3d& T_parent_child) {
  Link& link = linkOf(parent, child);
  if (link.parent == parent) link.fixed = T_parent_child;
}

void TransformTree::add(const std::string& parent, const std::string& child, double stamp_s,
                        const Eigen::Isometry3d& T_parent_child) {
  Link& link = linkOf(parent, child);
  if (link.parent == parent) link.poses.push_back({stamp_s, T_parent_child});
}

void TransformTree::sort() {
  for (auto& [child, link] : links_) {
    std::vector<StampedPose>& poses = link.poses;
    std::stable_sort(poses.begin(), poses.end(),
                     [](const StampedPose& a, const StampedPose& b) { return a.stamp_s < b.stamp_s; });
  }
}

std::set<std::string> TransformTree::frames() const {
  std::set<std::string> result;
  for (const auto& [child, link] : links_) result.insert({child, link.parent});
  return result;
}

TransformTree::Links TransformTree::linksAbove(const std::string& frame, std::vector<std::string>& frames) const {
  Links result;
  frames = {frame};
  for (auto link = links_.find(frame); link != links_.end(); link = links_.find(frames.back())) {
    // Damaged data may make a ring.
    if (std::find(frames.begin(), frames.end(), link->second.parent) != frames.end()) break;
    result.push_back(&link->second);
    frames.push_back(link->second.parent);
  }
  return result;
}

std::string TransformTree::rootOf(const std::string& frame) const {
  std::vector<std::string> frames;
  linksAbove(frame, frames);
  return frames.back();
}

bool TransformTree::linksBetween(const std::string& to, const std::string& from, Links& above_to,
                                 Links& above_from) const {
  std::vector<std::string> frames_to, frames_from;
  above_to = linksAbove(to, frames_to);
  above_from = linksAbove(from, frames_from);
  for (std::size_t i = 0; i < frames_from.size(); ++i) {
    const auto common = std::find(frames_to.begin(), frames_to.end(), frames_from[i]);
    if (common == frames_to.end()) continue;
    above_from.resize(i);
    above_to.resize(static_cast<std::size_t>(common - frames_to.begin()));
    return true;
  }
  return false;
}

bool TransformTree::connects(const std::string& a, const std::string& b) const {
  Links above_a, above_b;
  return linksBetween(a, b, above_a, above_b);
}

bool TransformTree::moves(const std::string& to, const std::string& from) const {
  Links above_to, above_from;
  if (!linksBetween(to, from, above_to, above_from)) return false;
  const auto moving = [](const Link* link) { return link->moves(); };
  return std::any_of(above_to.begin(), above_to.end(), moving) ||
         std::any_of(above_from.begin(), above_from.end(), moving);
}

std::optional<Eigen::Isometry3d> TransformTree::find(const std::string& to, const std::string& from,
                                                     double stamp_s) const {
  Links above_to, above_from;
  if (!linksBetween(to, from, above_to, above_from)) return std::nullopt;
  const auto product = [&](const Links& links) {
    std::optional<Eigen::Isometry3d> T = Eigen::Isometry3d::Identity();
    for (const Link* link : links) {
      const std::optional<Eigen::Isometry3d> T_parent_child = link->at(stamp_s);
      if (!T_parent_child) return std::optional<Eigen::Isometry3d>();
      T = *T_parent_child * *T;
    }
    return T;
  };
  const std::optional<Eigen::Isometry3d> T_common_to = product(above_to), T_common_from = product(above_from);
  if (!T_common_to || !T_common_from) return std::nullopt;
  return normalizedRotation(T_common_to->inverse() * *T_common_from);
}

}  // namespace saw_ndt::internal
