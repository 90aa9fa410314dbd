#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "saw_ndt/drives/recording.h"

namespace saw_ndt::internal {

/// Whether the name of a file is that of a scan: ends in .pcd, .ply or .bin.
bool isScanFile(const std::filesystem::path& path);
/// Puts files into the order of the stamps that all of their names are, else of their names, numbers by their value.
/// @return whether they are stamps
bool sortScans(std::vector<std::filesystem::path>& files);
/// Whether a folder holds .pcd, .ply or .bin files.
bool holdsScans(const std::filesystem::path& folder);

/// The scans of a folder of .pcd, .ply or .bin files, or one such file, in the order of the stamps or numbers that
/// their names are. Stamps are those of `times.txt`, `timestamps.txt` or `stamps.txt`, a line a scan, in the folder or
/// the one above it, else the names. `calib.txt` in either is KITTI's.
/// @throws Error where the folder has no scan, or scans of several kinds
std::unique_ptr<Recording> openScanFolder(const std::filesystem::path& folder, const RecordingOptions& options);

/// The reference poses of such a folder: `poses.txt`, `poses.tum` or `poses.csv` in it or in the one above it; empty
/// where there are none.
std::filesystem::path posesOfScanFolder(const std::filesystem::path& folder);

}  // namespace saw_ndt::internal
