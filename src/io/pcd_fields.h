#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "io/pcd_cloud.h"
#include "saw_ndt/common/scan_view.h"

namespace saw_ndt::internal {

/// Whether the name of a file says that it holds floats without a header.
inline bool isBinScan(const std::filesystem::path& path) { return path.extension() == ".bin"; }
/// Throws Error unless a name ends in .pcd, .ply or .bin.
void requireScanExtension(const std::filesystem::path& path);

/// Reads a PCD file or, where the name says so, a PLY file. Throws Error that names the line or the offset.
PcdCloud readCloudFile(const std::filesystem::path& path);

/// x y z and the intensity, 0 where there is none, of a cloud's points. Throws Error, naming the file, where a
/// coordinate is missing.
/// @param origin_m  taken off x y z before they become float
std::vector<LidarPoint> pointsOf(const std::filesystem::path& path, const PcdCloud& cloud,
                                 const std::array<double, 3>& origin_m = {});

/// All that readScanPoints() tells of a cloud. Throws Error as above.
ScanPoints scanPointsOf(const std::filesystem::path& path, const PcdCloud& cloud);

/// The field `label`. Throws Error where it is missing or has what is no whole number of 32 bits.
std::vector<std::uint32_t> labelsOf(const std::filesystem::path& path, const PcdCloud& cloud);

/// A cloud of x y z intensity, and of ring and time where they are known.
PcdCloud cloudOf(const ScanPoints& scan);

}  // namespace saw_ndt::internal
