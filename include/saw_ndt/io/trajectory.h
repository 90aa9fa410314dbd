#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {

/// The text formats of trajectories.
enum class TrajectoryFormat {
  TUM,    ///< stamp tx ty tz qx qy qz qw
  KITTI,  ///< 12 numbers, the upper 3x4 of the pose row by row; no stamps
  CSV,    ///< values separated by commas: see readTrajectory()
};

/// The time from a scan to the next where a KITTI trajectory comes without stamps.
constexpr double kNominalScanPeriod_s = 0.1;

/// A trajectory file's poses, as the file states them, and its format.
struct Trajectory {
  TrajectoryFormat format = TrajectoryFormat::TUM;
  std::vector<StampedPose> poses;  ///< stamps of a KITTI file: position in the file times kNominalScanPeriod_s
};

/// Reads a trajectory in any format. What has a comma in its first line is CSV, the others are told apart by the number
/// of columns. In all readers below lines that are blank
/// or start with '#' are skipped, and what is wrong is an Error that names the line: another number of columns, what is
/// no finite number, a quaternion whose norm is off 1 by more than 1e-3, a matrix that is no rigid transform to within
/// 1e-3. A file without poses is an Error too. Rotations are returned normalized.
///
/// CSV has the columns stamp, x, y, z, qx, qy, qz, qw in this order, or a first line of names that say which column is
/// which; others are then not read. The line of names may start with '#'. A name is made of words, of which capitals do
/// not matter, and may end in its unit, such as `stamp_s`, `x_m` or `p_RS_R_x [m]`:
/// - stamp: the word stamp, timestamp, time or t; in s, ms, us or ns. Where no unit is named it is s, or ns above 1e17.
/// - position: x, y, z, alone or after p, pos, position, t or translation; tx, px and the like; in m.
/// - quaternion: qx, qy, qz, qw, or x, y, z, w after q, quat, quaternion, orientation or rotation.
SAW_NDT_EXPORT Trajectory readTrajectory(const std::filesystem::path& path);

/// Reads stamped poses in TUM format.
SAW_NDT_EXPORT std::vector<StampedPose> readTumTrajectory(const std::filesystem::path& path);

/// Reads poses in KITTI format; those of the KITTI benchmark are of the left camera (lidarPose() converts them).
SAW_NDT_EXPORT std::vector<Eigen::Isometry3d> readKittiTrajectory(const std::filesystem::path& path);

/// Reads one stamp a line: seconds, as KITTI's times.txt, or a date and time in UTC, as KITTI's raw data have it, which
/// become seconds since 1970. Throws Error that names the line.
SAW_NDT_EXPORT std::vector<double> readStamps(const std::filesystem::path& path);

/// Writes one stamp (s) a line with 9 decimals. Throws Error.
SAW_NDT_EXPORT void writeStamps(const std::filesystem::path& path, const std::vector<double>& stamps_s);

/// Writes TUM format: stamps and positions with 9 decimals, quaternions (qw >= 0) with 12. Throws Error.
SAW_NDT_EXPORT void writeTumTrajectory(const std::filesystem::path& path, const std::vector<StampedPose>& trajectory);

/// Writes KITTI format with 13 significant digits. Throws Error.
SAW_NDT_EXPORT void writeKittiTrajectory(const std::filesystem::path& path,
                                         const std::vector<Eigen::Isometry3d>& poses);

/// The LiDAR's pose in the first LiDAR frame from the camera's in the first camera frame: Tr^-1 P Tr, normalized.
SAW_NDT_EXPORT Eigen::Isometry3d lidarPose(const Eigen::Isometry3d& camera_pose,
                                           const Eigen::Isometry3d& T_camera_lidar);

/// The camera's pose in the first camera frame from the LiDAR's in the first LiDAR frame: Tr T Tr^-1, normalized.
SAW_NDT_EXPORT Eigen::Isometry3d cameraPose(const Eigen::Isometry3d& lidar_pose,
                                            const Eigen::Isometry3d& T_camera_lidar);

}  // namespace saw_ndt
