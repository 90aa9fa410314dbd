#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/drives/scan_source.h"
#include "saw_ndt/localization/scan_preparation.h"
#include "saw_ndt/map/weighted_map_builder.h"
#include "saw_ndt/segmentation/scan_segmenter.h"

namespace saw_ndt {

struct DriveMapOptions {
  /// Edge of a voxel: of the smallest that `weighted` can match; the paper's methods put voxels of 1 m together.
  double resolution_m = 0.5;
  std::optional<SegmentationOptions> segmentation = SegmentationOptions();  ///< none: raw points without labels
  /// Where scans are skewed by the motion of the LiDAR: how points are told when they were measured. They are brought
  /// to where they are seen at the stamp, by the motion of `trajectory`.
  MotionCompensation motion_compensation = MotionCompensation::OFF;
  double scan_period_s = 0.1;           ///< how long a turn of the LiDAR takes, where azimuths tell times
  std::vector<StampedPose> trajectory;  ///< T_map_lidar of the whole drive by growing stamps, for that motion
  int threads = 0;                      ///< 0: all cores; the map does not depend on it
  /// Called with the reason of each scan that could not be read or has no reference pose, in order and from any thread:
  /// it is left out. None: such a scan is an error.
  std::function<void(const std::string& failure)> scan_left_out;

  /// Throws std::invalid_argument that names the field and its value.
  SAW_NDT_EXPORT void check() const;
};

/// Adds the scans of a source, segmented and moved by their reference poses, to a new builder.
/// @param scan_done  called after each scan, from any thread; may be empty
/// @throws Error where a scan cannot be read or has no reference pose (see scan_left_out), the first such scan's; where
///         no scan is left; where a scan to be compensated by times has none, or the trajectory
///         none of its stamp. std::invalid_argument for options that do not hold
SAW_NDT_EXPORT WeightedMapBuilder buildDriveMap(ScanSource& scans, const DriveMapOptions& options,
                                                const std::function<void()>& scan_done = {});

/// The same, to a builder that may have scans already, such as those of other drives. That no scan is left is no error.
/// @param map  of options.resolution_m; its own segmentation is what the map tells, and may be that of another mounting
SAW_NDT_EXPORT void addScans(ScanSource& scans, const DriveMapOptions& options, WeightedMapBuilder& map,
                             const std::function<void()>& scan_done = {});

}  // namespace saw_ndt
