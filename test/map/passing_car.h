#pragma once

#include <vector>

#include "localization/synthetic_drive.h"

namespace saw_ndt {

/// Whether a position in the ground's frame (m) is where the car or the person of driveAmongTraffic() passes, above the
/// ground; nothing that stands is there.
inline bool isOnTheLane(const Eigen::Vector3d& position) {
  return position.y() > 0.5 && position.y() < 4.6 && position.z() > 0.15 && position.z() < 2.5;
}

/// A drive down the street of streetBlocks(), 0.8 m from scan to scan, in the frame of the ground. A car comes to meet
/// it and a person walks along, both on the other lane.
inline SyntheticDrive driveAmongTraffic(const SensorModel& sensor, int scan_count) {
  SyntheticDrive drive;
  for (int i = 0; i < scan_count; ++i) {
    std::vector<Block> blocks = streetBlocks();
    const double car_x = 30.0 - 1.2 * i, person_x = -4.0 + 0.3 * i;
    blocks.push_back({{car_x, 0.8, 0.3}, {car_x + 4.2, 2.6, 1.5}});
    blocks.push_back({{person_x, 3.6, 0.0}, {person_x + 0.4, 4.1, 1.8}});
    Eigen::Isometry3d T_ground_lidar = Eigen::Isometry3d::Identity();
    T_ground_lidar.translation() << -15.0 + 0.8 * i, -2.0, 1.73;
    drive.stamps_s.push_back(0.1 * i);
    drive.T_map_lidar.push_back(T_ground_lidar);
    drive.scans.push_back(scanBlocks(blocks, sensor, T_ground_lidar, static_cast<unsigned>(i)));
  }
  return drive;
}

}  // namespace saw_ndt
