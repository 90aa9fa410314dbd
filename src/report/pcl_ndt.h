#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <Eigen/Geometry>
#include <functional>
#include <memory>

#include "saw_ndt/drives/scan_source.h"
#include "saw_ndt/localization/localizer.h"

namespace saw_ndt {

/// pcl::NormalDistributionsTransform as this project compares itself with it, kept out of the way here because it takes
/// long to compile: epsilon 1e-4, everything else PCL's default. It uses one thread.
class PclNdt {
 public:
  using Cloud = pcl::PointCloud<pcl::PointXYZ>;

  /// @param target        points of the map (m, map frame)
  /// @param resolution_m  edge of PCL's voxels, positive
  /// @throws std::invalid_argument where the target is a null pointer or the resolution not positive
  explicit PclNdt(const Cloud::ConstPtr& target, double resolution_m = 1.0);
  ~PclNdt();
  PclNdt(PclNdt&& other) noexcept;

  /// The centroids of a scan's points in voxels of 0.2 m, by pcl::VoxelGrid.
  static Cloud::Ptr thinned(const Cloud::ConstPtr& scan);

  /// Sets the source of what follows (m).
  void setSource(const Cloud::ConstPtr& source);
  /// Aligns the source. PCL calls an alignment that ran out of iterations converged.
  AlignmentResult align(const Eigen::Isometry3d& T_map_start);
  /// Score, gradient and Hessian of the source at a pose, by PCL's own loop; returns the score.
  double evaluate(const Eigen::Isometry3d& T_map_source);
  /// The pairs of a source point and a voxel that evaluate() adds up.
  std::size_t pairCount(const Eigen::Isometry3d& T_map_source);

 private:
  class Registration;

  std::unique_ptr<Registration> registration_;
};

/// PclNdt as the aligner of a Localizer, whose min_likelihood should be 0: likelihoods are told by a target of ours.
/// @param judge  by whose fine level the likelihoods are told
/// @throws std::invalid_argument as PclNdt
SourceAligner pclNdtAligner(const PclNdt::Cloud::ConstPtr& target, double resolution_m, const NdtTarget& judge);

/// The finite points of all scans of a source, moved by their reference poses (single precision, map frame).
/// @param scan_done  called after each scan; may be empty
/// @throws Error where a scan cannot be read or has no reference pose
PclNdt::Cloud::Ptr mapPoints(ScanSource& scans, const std::function<void()>& scan_done = {});

}  // namespace saw_ndt
