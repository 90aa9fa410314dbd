#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>

#include "saw_ndt/common/sensor_model.h"

namespace saw_ndt {

/// What a spinning LiDAR measures and how well. The defaults are those of the HDL-64E that recorded KITTI.
struct LidarOptions {
  /// The beams. Its name also fixes each beam's azimuth within a firing and constant range error: the same in every
  /// drive.
  SensorModel sensor = SensorModel::named("HDL-64E");
  int firings_per_turn = 2083;       ///< of each beam
  double scan_period_s = 0.1;        ///< time of a turn
  double field_of_view_deg = 360.0;  ///< of azimuth, half on either side of the LiDAR's x axis
  double min_range_m = 1.0;          ///< nearer returns are lost
  double max_range_m = 80.0;         ///< farther returns are lost
  /// How the LiDAR is turned on the vehicle: first about its x axis, positive raising its left side, 180 hanging upside
  /// down; then about the vehicle's y axis, by which its x axis points below the horizon.
  double mounting_roll_deg = 0.0, mounting_pitch_deg = 0.0;
  /// What of the vehicle itself hides the view (m), in the frame of a LiDAR that is not turned; empty: nothing. A van's
  /// roof.
  Eigen::AlignedBox3f own_vehicle{Eigen::Vector3f(-1.05f, -0.5f, -1.5f), Eigen::Vector3f(0.92f, 0.5f, -0.35f)};

  double range_noise_m = 0.015;       ///< standard deviation of one return
  double beam_range_offset_m = 0.02;  ///< standard deviation of the constant range errors of the beams
  double angle_jitter_rad = 1e-4;     ///< standard deviation of a ray's azimuth and elevation, not measured
  double beam_divergence_rad = 2e-3;  ///< full angle of a beam
  double pulse_length_m = 0.75;       ///< surfaces that are closer than this along a beam give one mixed return
  double edge_step_m = 0.1;           ///< a step in range from which two neighbouring returns lie on two surfaces

  /// Range (m) at which half the returns of a diffuse surface of reflectivity 0.1 are lost when hit at a right angle.
  double detection_range_m = 70.0;
  double power_fluctuation = 0.2;       ///< standard deviation of the natural logarithm of the received power
  double surface_roughness_rad = 0.35;  ///< slopes of the facets of surfaces: the rougher, the more comes back aslant
  double dropout_share = 0.001;         ///< share of the returns that are lost for no reason of theirs, 0 to 1

  /// Whether a scan is left as the moving sensor saw it, each point in the LiDAR's frame at its firing time. Otherwise
  /// all points are seen from the pose at the stamp, as in a scan with the vehicle's motion taken out.
  bool rolling_shutter = false;

  double rain_share = 0.0;         ///< share of the rays that meet a droplet, 0 to 1
  double rain_mean_range_m = 4.0;  ///< mean of the exponentially distributed ranges of droplets

  std::uint64_t seed = 1;  ///< of all that is random

  /// @throws std::invalid_argument that names the field
  void check() const;

  /// The rotation that the mounting is: from the LiDAR to the axes of the vehicle.
  Eigen::Matrix3d R_vehicle_lidar() const;

  /// The options of a sensor: those of the data sheet of the LiDAR of its name, or of any LiDAR of medium range that
  /// fires once a column.
  static LidarOptions of(const SensorModel& sensor);
  /// The options of a sensor of SensorModel::named(). @throws std::invalid_argument that lists the known ones
  static LidarOptions named(const std::string& sensor);
};

}  // namespace saw_ndt
