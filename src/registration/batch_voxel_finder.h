#pragma once

#include <Eigen/Geometry>

#include "registration/batch_workspace.h"
#include "registration/ndt_kernel.h"
#include "registration/ordered_source.h"
#include "registration/voxel_pairs.h"

namespace saw_ndt::internal {

/// Scratch memory of one thread.
struct BatchScratch {
  BatchPoints points{};
  BatchVoxels voxels{};
  BatchUnits units{};
};

/// Sums over a batch of points towards Likelihoods.
struct LikelihoodSums {
  BatchScores scores{};
  std::size_t matched_points = 0;
};

/// Moves batches of source points to a map level and finds the voxels that each run of points pairs with. Threads may
/// share one.
class BatchVoxelFinder {
 public:
  /// @param level  is referred to, not copied
  BatchVoxelFinder(const internal::NdtLevel& level, NeighborhoodSearchMethod method,
                   const Eigen::Isometry3d& T_map_source);

  /// Moves points of the source to the map and finds the voxels that they lie in, counted from origin(), without asking
  /// which of them exist. Puts the points in a better order first where runs are short.
  void place(OrderedSource& source, std::size_t first, std::size_t count, BatchScratch& scratch) const;
  /// The voxel that others are counted from.
  const VoxelCoordinate& origin() const { return origin_; }

  /// Fills the scratch memory from `count` points of the source, at most kPointsPerBatch.
  /// Puts them in a better order first where runs are short.
  void find(OrderedSource& source, std::size_t first, std::size_t count, BatchScratch& scratch) const;
  /// The same for points in the order that they have.
  void findInOrder(const OrderedSource& source, std::size_t first, std::size_t count, BatchScratch& scratch) const;

 private:
  void move(const OrderedSource& source, std::size_t first, std::size_t count, BatchScratch& scratch) const;
  void findVoxels(BatchScratch& scratch) const;
  template <typename NeighbourRows>
  void findVoxelsIn(const NeighbourRows& neighbour_rows, BatchScratch& scratch) const;
  void cutIntoUnits(BatchScratch& scratch) const;

  const internal::NdtLevel& level_;
  NeighborhoodSearchMethod method_;
  std::size_t points_per_unit_ = pointsPerUnit();
  std::size_t units_per_vector_ = unitsPerVector();
  VoxelCoordinate origin_;
  BatchPose pose_;
};

/// The pose of a batch, and the voxel that its positions are taken from: the one that holds the source's origin.
struct AnchoredPose {
  AnchoredPose(const Eigen::Isometry3d& T_map_source, double resolution_m);
  VoxelCoordinate origin;
  BatchPose pose;
};

}  // namespace saw_ndt::internal
