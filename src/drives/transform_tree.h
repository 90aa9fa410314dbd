#pragma once

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt::internal {

/// Frames that hang on each other, as `tf` tells them: each has one parent, and where it is in that one may change.
class SAW_NDT_EXPORT TransformTree {
 public:
  /// States that a frame is where it is at all times.
  void setFixed(const std::string& parent, const std::string& child, const Eigen::Isometry3d& T_parent_child);
  /// States where a frame was at a moment; stamps in any order. What names another parent than the first one did is
  /// left out.
  void add(const std::string& parent, const std::string& child, double stamp_s,
           const Eigen::Isometry3d& T_parent_child);
  /// To be called when all is added, before what follows.
  void sort();

  /// All frames.
  std::set<std::string> frames() const;
  /// The frame above all others that a frame hangs on, itself where it hangs on none.
  std::string rootOf(const std::string& frame) const;
  /// Whether two frames hang together.
  bool connects(const std::string& a, const std::string& b) const;
  /// Whether a frame moves in another one that it hangs together with.
  bool moves(const std::string& to, const std::string& from) const;
  /// T_to_from at a moment, each link of the chain interpolated between the two stamps around it. Nothing where the
  /// frames do not hang together or a link tells nothing of this moment.
  std::optional<Eigen::Isometry3d> find(const std::string& to, const std::string& from, double stamp_s) const;

 private:
  struct Link {
    std::string parent;
    std::optional<Eigen::Isometry3d> fixed;
    std::vector<StampedPose> poses;  // T_parent_child

    bool moves() const;
    std::optional<Eigen::Isometry3d> at(double stamp_s) const;
  };
  using Links = std::vector<const Link*>;

  Link& linkOf(const std::string& parent, const std::string& child);
  /// The links from a frame up to its root, and the frames below them with the root.
  Links linksAbove(const std::string& frame, std::vector<std::string>& frames) const;
  /// The links from each of two frames up to the first frame above both. False where there is none.
  bool linksBetween(const std::string& to, const std::string& from, Links& above_to, Links& above_from) const;

  std::map<std::string, Link> links_;  // by the child
};

}  // namespace saw_ndt::internal
