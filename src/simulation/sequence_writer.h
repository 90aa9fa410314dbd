#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <functional>
#include <vector>

#include "simulation/lidar_simulator.h"
#include "simulation/vehicle_motion.h"

namespace saw_ndt {

/// The LiDAR in the frame of the left camera that written sequences state: 0.27 m ahead of the LiDAR and 0.08 m below
/// it, looking forward, with errors of mounting of some tenths of a degree.
Eigen::Isometry3d simulatedCalibration();

/// What a written sequence holds.
struct SequenceContent {
  int scan_count = 0;
  std::size_t point_count = 0;  ///< of all scans
};

/// Casts every scan of a motion and writes a sequence in KITTI odometry layout, with SemanticKITTI labels:
/// `velodyne/000000.bin`, `labels/000000.label` and so on, `calib.txt`, `times.txt` and `poses.txt`, the camera's
/// poses Tr T_scene_lidar Tr^-1. These are not relative to the first one, so that drives through one scene share the
/// scene as their map frame. The same input gives the same bytes.
///
/// @param folder     must exist; files of these names are replaced
/// @param reference  what poses.txt states, one pose a scan; empty: the true poses. Where it differs from them,
///                   the truth is written to `poses_true.txt`.
/// @param progress   called after each scan
/// @throws Error where a file cannot be written, std::invalid_argument as LidarSimulator::scan() and for a motion
///         without scans or another number of reference poses
SequenceContent writeSequence(const std::filesystem::path& folder, LidarSimulator& simulator,
                              const VehicleMotion& motion, const std::vector<Eigen::Isometry3d>& reference = {},
                              const std::function<void()>& progress = {});

}  // namespace saw_ndt
