#include <cmath>

#include "fuzzed_file.h"
#include "io/velodyne_calibration.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static saw_ndt::FuzzedFile file("db.xml");
  file.tryReading(data, size, [](const std::filesystem::path& path) {
    for (const saw_ndt::internal::VelodyneCorrection& laser : saw_ndt::internal::readVelodyneCalibration(path)) {
      saw_ndt::require(std::isfinite(laser.azimuth_deg + laser.elevation_deg + laser.distance_m +
                                     laser.vertical_offset_m + laser.horizontal_offset_m),
                       "corrections are finite");
    }
  });
  return 0;
}
