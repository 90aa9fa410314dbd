#pragma once

#include <filesystem>
#include <memory>

#include "saw_ndt/drives/recording.h"

namespace saw_ndt::internal {

/// Whether a folder is a drive of KITTI's raw data: has `velodyne_points/data`.
bool isKittiRawDrive(const std::filesystem::path& folder);
/// Opens it. Stamps are those of `velodyne_points/timestamps.txt` (seconds since 1970, its times taken as UTC),
/// reference poses come from `oxts`, of the same scan, and `calib_imu_to_velo.txt`, calibration from
/// `calib_velo_to_cam.txt` and `calib_cam_to_cam.txt`, which lie in the folder of the day above, or in this one.
/// @throws Error where there is no scan
std::unique_ptr<Recording> openKittiRawDrive(const std::filesystem::path& folder, const RecordingOptions& options);

/// Whether a folder is a sequence of KITTI's tracking benchmark: `velodyne/<name>`, beside `calib/<name>.txt`.
bool isKittiTrackingSequence(const std::filesystem::path& folder);
/// Opens it. Stamps are 0.1 s apart, as the benchmark's scans are; reference poses come from `oxts/<name>.txt`.
/// @throws Error where there is no scan
std::unique_ptr<Recording> openKittiTrackingSequence(const std::filesystem::path& folder,
                                                     const RecordingOptions& options);

}  // namespace saw_ndt::internal
