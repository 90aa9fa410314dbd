#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt {

namespace internal {
class NdtLevel;
}

/// Which cells of its voxels a target keeps.
enum class CellPrecision {
  SINGLE,             ///< what Arithmetic::SINGLE reads
  SINGLE_AND_DOUBLE,  ///< what Arithmetic::DOUBLE reads as well, at more than twice the memory
};

/// What scans are registered to: the weighted NDT map of the paper (Section III.B). For every voxel it has mean,
/// inverse covariance, mean confidence and weight, on one level or, where VoxelWeighting::sizes asks for several sizes
/// of voxels, on a level of each, and on a coarse one to start on; larger voxels add up the sums of smaller ones.
/// Derived once from the sums of a map with one weighting, and then apart from them. A value: immutable, cheap to copy
/// since copies share the levels, and safe to read from many threads.
class SAW_NDT_EXPORT NdtTarget {
 public:
  /// A target without voxels.
  NdtTarget();
  /// @param threads  0: all cores; the target does not depend on it
  /// @throws std::invalid_argument where the weighting does not hold
  explicit NdtTarget(const WeightedVoxelMap& map, const VoxelWeighting& weighting = {}, int threads = 0,
                     CellPrecision precision = CellPrecision::SINGLE);

  /// The target of a map file of either kind. Of a WeightedVoxelMap it is that of the map read from it, without ever
  /// having the sums of all of its voxels in memory, only those of larger ones. Of a LocalizationMap it is its target.
  /// @throws Error as WeightedVoxelMap::load() and LocalizationMap, and where one of the latter was made with another
  /// weighting. std::invalid_argument where the weighting does not hold
  static NdtTarget load(const std::string& path, const VoxelWeighting& weighting = {}, int threads = 0);

  const MapOrigin& origin() const;
  /// Edge of its smallest voxels (m).
  double resolution() const;
  /// Whether the points carried labels; without them there are no weights, and matching is classical NDT.
  bool labelled() const { return origin().labelled; }
  const VoxelWeighting& weighting() const;

  /// How many voxels have a distribution, on all levels but a coarse one that serves the start alone.
  std::size_t voxelCount() const;
  /// How many voxels the coarse level has; 0 where there is none.
  std::size_t coarseVoxelCount() const;
  /// Whether there is nothing to match against.
  bool empty() const { return voxelCount() == 0; }
  /// The means of those voxels in the map frame (m), level by level and tile after tile, exact to about 1e-7 of a
  /// voxel.
  std::vector<Eigen::Vector3d> means() const;
  /// Whether two targets are copies of one.
  bool sharesLevelsWith(const NdtTarget& other) const { return levels_ == other.levels_; }

  /// For this project's own code.
  /// @param levels  as planTarget() has them for the weighting, the coarse one last where there is one
  static NdtTarget ofLevels(const MapOrigin& origin, const VoxelWeighting& weighting,
                            std::vector<internal::NdtLevel> levels);
  const std::vector<internal::NdtLevel>& levels() const;  ///< those that match, the finest first
  const internal::NdtLevel& fine() const;                 ///< the finest
  const internal::NdtLevel& coarse() const;

 private:
  struct Levels;
  explicit NdtTarget(std::shared_ptr<const Levels> levels) : levels_(std::move(levels)) {}

  std::shared_ptr<const Levels> levels_;
};

}  // namespace saw_ndt
