#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {

/// How far a localizer knows where the vehicle is.
enum class TrackStatus {
  NOT_INITIALIZED,  ///< no pose has been given yet
  TRACKING,         ///< the last scan was accepted, or an initial pose was given since
  COASTING,         ///< the last scans were rejected: poses are predictions
  RELOCALIZING,     ///< lost, and the last scan was looked for in all of the map
  LOST,             ///< so many were that predictions are worth little; see MotionPredictionOptions::lost_after_scans
};

/// "not initialized", "tracking", "coasting", "relocalizing", "lost"
SAW_NDT_EXPORT const char* toString(TrackStatus status);

/// What a localizer knows of the vehicle between two scans.
struct TrackState {
  TrackStatus status = TrackStatus::NOT_INITIALIZED;
  bool pose_known = false;  ///< false: the vehicle may be anywhere, and T_map_base says nothing
  Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();  ///< the last accepted pose, or the initial one
  Matrix6d covariance = Matrix6d::Zero();  ///< of that pose, as AlignmentResult::covariance about the base's origin
  std::optional<double> stamp_s;           ///< of that pose; of an initial pose, that of the first scan
  /// Whether two accepted poses with growing stamps are known, from which these velocities follow.
  bool velocity_known = false;
  Eigen::Vector3d velocity_base_mps = Eigen::Vector3d::Zero();     ///< in the frame of the moving base
  Eigen::Vector3d turn_rate_base_radps = Eigen::Vector3d::Zero();  ///< likewise
  int rejected_scans = 0;                                          ///< since the last accepted one
  /// Mean of AlignmentResult::overlap over the last accepted scans, where any was.
  std::optional<double> usual_overlap;

  /// Whether nobody knows where the vehicle is, looked for or not.
  bool isLost() const { return status == TrackStatus::LOST || status == TrackStatus::RELOCALIZING; }

  /// Seconds from the last accepted pose to a stamp; nothing where its stamp is not known.
  std::optional<double> timeSinceLast(double at_stamp_s) const {
    if (!stamp_s) return std::nullopt;
    return at_stamp_s - *stamp_s;
  }
};

}  // namespace saw_ndt
