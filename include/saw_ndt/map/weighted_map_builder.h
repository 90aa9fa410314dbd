#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <Eigen/Geometry>

#include "saw_ndt/map/voxel_sums_table.h"
#include "saw_ndt/map/weighted_voxel_map.h"
#include "saw_ndt/segmentation/scan_view.h"

namespace saw_ndt {

/// Collects labelled points into voxel sums, cloud after cloud. Memory grows with the voxels met, never with the
/// points; the result does not depend on the order of clouds or on how they were spread over builders.
class WeightedMapBuilder {
 public:
  /// @param resolution_m  edge of a voxel, positive
  /// @throws std::invalid_argument
  explicit WeightedMapBuilder(double resolution_m);

  /// Adds the finite points of a cloud. With a `label` field the points count under their StructuralLabel, without one
  /// the map becomes an unlabelled one; clouds of the two kinds do not mix.
  /// @param T_map_cloud  pose of the cloud's frame in the map frame
  /// @param threads      0: all cores; the result does not depend on it
  /// @throws std::invalid_argument for a label that is no StructuralLabel, a pose that is not finite, or mixed kinds
  template <typename PointT>
  void addCloud(const pcl::PointCloud<PointT>& cloud, const Eigen::Isometry3d& T_map_cloud, int threads = 1);

  /// Adds all that another builder of the same resolution has collected. @throws std::invalid_argument
  void merge(const WeightedMapBuilder& other);

  /// The map of everything added so far.
  /// @param threads  0: all cores; the result does not depend on it
  WeightedVoxelMap build(const VoxelWeighting& weighting = {}, int threads = 1) const;

 private:
  /// @param labels        that of the first point, a StructuralLabel; null where points have none
  /// @param label_stride  values from one point's label to the next one's
  void addPoints(const ScanView& points, const std::uint32_t* labels, std::size_t label_stride,
                 const Eigen::Isometry3d& T_map_cloud, int threads);
  void requireKind(bool labelled);

  MapOrigin origin_;
  VoxelSumsTable table_;
};

}  // namespace saw_ndt

#include "saw_ndt/map/impl/weighted_map_builder.hpp"
