#pragma once

#include <filesystem>
#include <memory>

#include "saw_ndt/common/export.h"
#include "saw_ndt/drives/scan_source.h"

namespace saw_ndt {

/// How much odometry may be off where its file does not say: these add up, as what drifts does.
struct OdometryDrift {
  double share = 0.02;     ///< of the way
  double deg_per_s = 0.5;  ///< of the heading

  /// Throws std::invalid_argument that names the field and its value.
  SAW_NDT_EXPORT void check() const;
};

/// Adds RecordedScan::priors.motion from a file of poses of the base in a frame of any origin: TUM format, or CSV with
/// the columns stamp_s, x_m, y_m, z_m, qx, qy, qz, qw, sigma_m, sigma_deg, the last two of the motion since the line
/// before; a line of names may come first. Poses are interpolated; scans that lie outside, or in a gap of more than a
/// second, have no motion. @throws Error where the file cannot be read, or its stamps do not grow
SAW_NDT_EXPORT std::unique_ptr<ScanSource> withOdometry(std::unique_ptr<ScanSource> scans,
                                                        const std::filesystem::path& path, const OdometryDrift& drift);

/// Adds RecordedScan::priors.position from a file of positions of the base in the map: TUM format, of which rotations
/// are not used, or CSV with the columns stamp_s, x_m, y_m, z_m and, where they are known, sigma_x_m, sigma_y_m,
/// sigma_z_m. A scan gets the position that is nearest in time, if that is not more than 0.05 s away. @throws Error as
/// above
/// @param sigma_m  standard deviations where the file has none
SAW_NDT_EXPORT std::unique_ptr<ScanSource> withPositions(std::unique_ptr<ScanSource> scans,
                                                         const std::filesystem::path& path, double sigma_m);

}  // namespace saw_ndt
