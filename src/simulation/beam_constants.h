#pragma once

#include <vector>

#include "simulation/lidar_options.h"

namespace saw_ndt {

/// What tells the beams of a sensor apart, the same in every drive: drawn once from the sensor's name.
struct BeamConstants {
  std::vector<double> firing_offsets;   ///< azimuth in steps from one firing to the next, 0 to 1
  std::vector<double> range_offsets_m;  ///< added to every range
};

BeamConstants beamConstants(const LidarOptions& options);

}  // namespace saw_ndt
