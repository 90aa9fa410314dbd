#pragma once

#include <array>
#include <filesystem>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// How a laser of an HDL-64E differs from one in the middle that looks straight ahead.
struct VelodyneCorrection {
  double azimuth_deg = 0.0;  ///< clockwise
  double elevation_deg = 0.0;
  double distance_m = 0.0;  ///< added to what it measures
  double vertical_offset_m = 0.0;
  double horizontal_offset_m = 0.0;
};

/// Reads the calibration of an HDL-64E as Velodyne delivers it (db.xml). Throws Error where it is no such file, where a
/// laser is missing, stated twice or has no finite figures, or where the unit of distances is not 2 mm.
SAW_NDT_EXPORT std::array<VelodyneCorrection, 64> readVelodyneCalibration(const std::filesystem::path& path);

}  // namespace saw_ndt::internal
