#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <functional>
#include <memory>
#include <vector>

#include "saw_ndt/io/kitti.h"
#include "saw_ndt/localization/localizer.h"

namespace saw_ndt {

/// pcl::NormalDistributionsTransform in the place of a Localizer, for comparison: the same prediction and limits of
/// correction, PCL's own voxels of the target's raw points, the source thinned by pcl::VoxelGrid. PCL calls an
/// alignment that ran out of iterations converged; its likelihood is not judged. It uses one thread.
class PclNdtLocalizer {
 public:
  /// @param target        points of the map (m, map frame)
  /// @param resolution_m  edge of PCL's voxels, positive
  /// @param judge         target by whose fine level the likelihoods are told, outside of the measured time
  /// @param options       mounting, source_voxel_size_m, prediction and limits of correction; the rest does not matter
  /// @throws std::invalid_argument where an option does not hold, or the target is a null pointer
  PclNdtLocalizer(const pcl::PointCloud<pcl::PointXYZ>::ConstPtr& target, double resolution_m, NdtTarget judge,
                  const LocalizerOptions& options);
  ~PclNdtLocalizer();

  /// Where the vehicle is at the first scan. @throws std::invalid_argument unless it is finite
  void setInitialPose(const Eigen::Isometry3d& T_map_base);

  /// @param scan     in the LiDAR frame
  /// @param stamp_s  time of the scan; stamps should grow
  LocalizationResult localize(const ScanView& scan, double stamp_s);

 private:
  class Registration;

  NdtTarget judge_;
  LocalizerOptions options_;
  MotionPrediction prediction_;
  std::unique_ptr<Registration> registration_;
};

/// The finite points of the given scans of a drive, moved by their reference poses (single precision, map frame).
/// @param scan_done  called after each scan; may be empty
/// @throws Error where a file is missing or damaged
pcl::PointCloud<pcl::PointXYZ>::Ptr mapPoints(const KittiSequence& sequence, const std::vector<int>& scans,
                                              const std::function<void()>& scan_done = {});

}  // namespace saw_ndt
