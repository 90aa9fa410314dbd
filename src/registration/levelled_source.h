#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "registration/batch_workspace.h"
#include "registration/ordered_source.h"
#include "saw_ndt/map/ndt_target.h"

namespace saw_ndt::internal {

/// The points of a source by the level of a target that they are matched on: the finest that has a voxel where they lie
/// at a pose, or the last. Ground may be kept apart. Memory is kept between uses.
class LevelledSource {
 public:
  /// Takes points over.
  /// @param source        is put in order for the finest level at that pose
  /// @param first_level   finer ones get no points
  /// @param ground_apart  whether parts of the ground follow those of the rest
  /// @param threads       the result does not depend on it
  void assign(const NdtTarget& target, OrderedSource& source, const Eigen::Isometry3d& T_map_source,
              std::size_t first_level, bool ground_apart, int threads, BatchWorkspace& workspace);

  /// The points of each level of the target, then, where it is apart, the ground of each.
  std::vector<OrderedSource>& parts() { return parts_; }
  /// Which level of the target a part is of.
  std::size_t levelOf(std::size_t part) const { return part % level_count_; }
  bool isGround(std::size_t part) const { return part >= level_count_; }
  std::size_t size() const { return part_of_point_.size(); }
  std::size_t nonGroundCount() const;

 private:
  std::size_t level_count_ = 1;
  std::vector<std::uint8_t> part_of_point_;
  std::vector<OrderedSource> parts_;
};

}  // namespace saw_ndt::internal
