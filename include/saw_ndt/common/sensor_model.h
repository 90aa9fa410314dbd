#pragma once

#include <string>
#include <vector>

#include "saw_ndt/common/export.h"

namespace saw_ndt {

/// The scan pattern of a LiDAR: how a range image of its scans is laid out.
struct SAW_NDT_EXPORT SensorModel {
  /// How error messages call it.
  std::string name;
  /// Width of the range image: pixels per revolution.
  int columns = 0;
  /// Elevation of every beam in degrees, top row first, strictly decreasing. Empty for a LiDAR without beams, such as
  /// one whose mirrors sweep: its scans are segmented on a grid around the sensor.
  std::vector<double> elevations_deg;

  /// Height of the range image: one row per beam, 0 for a LiDAR without beams.
  int rows() const { return static_cast<int>(elevations_deg.size()); }

  /// Throws std::invalid_argument that names the field unless: no control character in the name, at most 1024 rows, 8
  /// to 16384 columns, elevations within (-90, 90) degrees and strictly decreasing.
  void check() const;

  /// The model of that name: a LiDAR of data/sensors, such as "HDL-64E", "VLP-16", "OS1-64" or "Pandar64", or
  /// "no-rings" for any other whose points have no beams, merged clouds included. Nominal beams: those of one unit
  /// differ by tenths of a degree. Any other name throws std::invalid_argument that lists the known ones.
  static SensorModel named(const std::string& name);

  /// The names that named() knows.
  static std::vector<std::string> names();

  /// A sensor whose beams are evenly spaced from `top_deg` down to `bottom_deg`, both included; checked.
  static SensorModel evenlySpaced(const std::string& name, int rows, int columns, double top_deg, double bottom_deg);
};

}  // namespace saw_ndt
