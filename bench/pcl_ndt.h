#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <Eigen/Geometry>
#include <memory>

namespace saw_ndt {

/// pcl::VoxelGrid and pcl::NormalDistributionsTransform as the benchmarks set them up, kept out of the way here because
/// they take long to compile: epsilon 1e-4, everything else PCL's default, voxels of 1 m among it. One thread.
class PclNdt {
 public:
  using Cloud = pcl::PointCloud<pcl::PointXYZ>;

  /// @param target  points of the map (m, map frame)
  explicit PclNdt(const Cloud::ConstPtr& target);
  ~PclNdt();

  /// The centroids of a scan's points in voxels of 0.2 m, by pcl::VoxelGrid.
  static Cloud::Ptr thinned(const Cloud::ConstPtr& scan);

  /// Sets the source of what follows, a thinned scan (m, LiDAR frame).
  void setSource(const Cloud::ConstPtr& source);
  /// Aligns the source; returns the number of PCL's iterations.
  int align(const Eigen::Isometry3d& T_start);
  /// Score, gradient and Hessian of the source at a pose, by PCL's own loop; returns the score.
  double evaluate(const Eigen::Isometry3d& T_map_source);
  /// The pairs of a source point and a voxel that evaluate() adds up.
  std::size_t pairCount(const Eigen::Isometry3d& T_map_source);

 private:
  class Registration;

  std::unique_ptr<Registration> registration_;
};

}  // namespace saw_ndt
