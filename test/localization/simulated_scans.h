#pragma once

#include <cstdint>
#include <string>

#include "localization/synthetic_drive.h"
#include "simulation/lidar_simulator.h"
#include "simulation/short_drive.h"

namespace saw_ndt {

/// Scans `first` to `last`, every `step`-th, of a drive through the beginning of a simulated scene. Drives differ in
/// traffic and the way within the lane; their map frame is that of the scene.
inline SyntheticDrive simulatedScans(const std::string& scene, int number, int first, int last, int step = 1) {
  DriveOptions options;
  options.drive = number;
  const SimulatedDrive simulated = shortDrive(scene, options, last);
  LidarOptions lidar;
  lidar.seed = static_cast<std::uint64_t>(number);
  LidarSimulator simulator(simulated.scene, lidar);
  SyntheticDrive drive;
  for (int scan = first; scan < last; scan += step) {
    drive.stamps_s.push_back(simulated.motion->stamps_s[static_cast<std::size_t>(scan)]);
    drive.T_map_lidar.push_back(simulated.motion->T_scene_lidar[static_cast<std::size_t>(scan)]);
    drive.scans.push_back(simulator.scan(*simulated.motion, scan).points);
  }
  return drive;
}

}  // namespace saw_ndt
