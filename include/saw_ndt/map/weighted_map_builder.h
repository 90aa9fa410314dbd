#pragma once

#include <Eigen/Geometry>

#include "map/voxel_sums_table.h"
#include "saw_ndt/common/labels.h"
#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt {

/// Collects labelled points into voxel sums, scan after scan. Memory grows with the voxels met, never with the
/// points; the result does not depend on the order of scans or on how they were spread over builders.
class WeightedMapBuilder {
 public:
  /// @param resolution_m  edge of a voxel, positive
  /// @throws std::invalid_argument
  explicit WeightedMapBuilder(double resolution_m);

  /// Adds the finite points of a scan. With labels the points count under them, without any the map becomes an
  /// unlabelled one; scans of the two kinds do not mix. addCloud() of pcl/cloud_view.h adds clouds of PCL.
  /// @param labels      of each point of the scan, values of StructuralLabel
  /// @param T_map_scan  pose of the scan's frame in the map frame
  /// @param threads     0: all cores; the result does not depend on it
  /// @throws std::invalid_argument for a pose that is not finite, or mixed kinds
  void addScan(const ScanView& scan, const LabelView& labels, const Eigen::Isometry3d& T_map_scan, int threads = 1);

  /// Adds all that another builder of the same resolution has collected. @throws std::invalid_argument
  void merge(const WeightedMapBuilder& other);

  /// The map of everything added so far.
  /// @param threads  0: all cores; the result does not depend on it
  WeightedVoxelMap build(const VoxelWeighting& weighting = {}, int threads = 1) const;

 private:
  void requireKind(bool labelled);

  MapOrigin origin_;
  VoxelSumsTable table_;
};

}  // namespace saw_ndt
