#pragma once

#include <cstdint>

namespace saw_ndt {

/// What tells one drive through a scene from another.
struct DriveOptions {
  std::uint64_t seed = 1;        ///< of the scene: what stays the same in all its drives
  int drive = 1;                 ///< 1 or more: traffic, parked cars, the way within the lane; 1 keeps to its middle
  double object_density = 1.0;   ///< share of the objects along the road that are there, 0 to 1
  double traffic_density = 1.0;  ///< factor of the number of vehicles and persons on the way, 0 to 10

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

}  // namespace saw_ndt
