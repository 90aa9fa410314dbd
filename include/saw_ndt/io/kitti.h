#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/scan_view.h"

namespace saw_ndt {

/// Reads a Velodyne scan: little-endian float32 x y z reflectance a point, metres, LiDAR frame; the intensity is the
/// reflectance. Points that are not finite are kept. Throws Error where the file is missing, empty, ends within a point
/// (naming the offset), seems to have another number of floats a point, or has coordinates that no scan has.
/// readScanPoints() reads five and six floats a point.
SAW_NDT_EXPORT std::vector<LidarPoint> readKittiScan(const std::filesystem::path& path);
/// The same into memory that `points` may bring along.
SAW_NDT_EXPORT void readKittiScan(const std::filesystem::path& path, std::vector<LidarPoint>& points);

/// Reads SemanticKITTI labels: the class of each point of a scan, the low 16 bits of a uint32. Throws Error as
/// readKittiScan().
SAW_NDT_EXPORT std::vector<std::uint16_t> readSemanticKittiLabels(const std::filesystem::path& path);

/// Writes a Velodyne scan as readKittiScan() reads it, whole or not at all. Throws Error.
SAW_NDT_EXPORT void writeKittiScan(const std::filesystem::path& path, const std::vector<LidarPoint>& points);

/// Writes SemanticKITTI labels, the class of each point of a scan, whole or not at all. Throws Error.
SAW_NDT_EXPORT void writeSemanticKittiLabels(const std::filesystem::path& path,
                                             const std::vector<std::uint16_t>& classes);

/// Writes a KITTI calib.txt: `Tr`, and `P0` to `P3` of four cameras side by side such as KITTI's. Throws Error.
SAW_NDT_EXPORT void writeKittiCalibration(const std::filesystem::path& path, const Eigen::Isometry3d& T_camera_lidar);

/// Reads the transform from the LiDAR to the left camera: the line `Tr` of a KITTI calib.txt, or else R0 Tr with the
/// line `Tr_velo_to_cam` (or `Tr_velo_cam`) and the rotation `R0_rect` (or `R_rect`), where there is one. Colons and
/// blanks before them may be there or not. Throws Error, naming the line, where it is missing or no rigid transform.
SAW_NDT_EXPORT Eigen::Isometry3d readKittiCalibration(const std::filesystem::path& path);

}  // namespace saw_ndt
