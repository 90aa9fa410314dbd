#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "saw_ndt/common/export.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/drives/scan_source.h"
#include "saw_ndt/localization/localizer.h"
#include "saw_ndt/map/tiled_target.h"

namespace saw_ndt {

/// Whether the scans of a drive are skewed by the motion of the LiDAR, as a trial found out.
struct MotionTrial {
  MotionCompensation compensation = MotionCompensation::OFF;  ///< by which scans agree best; OFF where it cannot tell
  std::string reason;                                         ///< in words, with the figures
};

/// Aligns some scans to a map by each way of compensation: by the times of the points where they differ, else by the
/// azimuth in both directions; and as they are. They are the first ones in which the vehicle moves points 20 m away by
/// 0.2 m a turn, ten at most; their motion is that between the poses of a localizer that takes them as they are. Where
/// it finds fewer than four, each way has a localizer of its own. A way is taken where likelihood times overlap
/// (AlignmentResult's) is on average by 1 % and by three standard errors greater than that of every other, the scans as
/// they are among them.
/// @param target   of the map, made with options.method.voxels; or an NdtTarget
/// @param options  of the localizer; its motion_compensation is not looked at
/// @param T_map_base_initial  at the first scan; nothing: not known
/// @param scans    is read as far as needed
SAW_NDT_EXPORT MotionTrial tryMotionCompensation(const TiledTarget& target, const LocalizerOptions& options,
                                                 const std::optional<Eigen::Isometry3d>& T_map_base_initial,
                                                 ScanSource& scans);

/// The same for a drive with reference poses and no map yet: some scans are put together to a map by their poses, and
/// others between them aligned to it.
/// @param options  of the map; its motion_compensation is not looked at
SAW_NDT_EXPORT MotionTrial tryMotionCompensation(const DriveMapOptions& options, ScanSource& scans);

}  // namespace saw_ndt
