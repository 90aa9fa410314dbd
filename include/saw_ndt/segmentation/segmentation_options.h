#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/sensor_model.h"

namespace saw_ndt {

/// How ground is told in a range image.
enum class GroundRule {
  /// The paper's and LeGO-LOAM's: the line between vertically adjacent pixels is nearly level.
  INCLINATION,
  /// Ground is followed outward from below the sensor, column by column: a return belongs to it where it lies on from
  /// the last ground return and near the height that ground may have reached by then. What lies at the foot of a return
  /// that is no ground becomes doubtful; then neighbours settle what is doubtful.
  GROWING,
};

/// Options of GroundDetection.
struct SAW_NDT_EXPORT GroundOptions {
  /// Which rule applies.
  GroundRule rule = GroundRule::GROWING;

  /// Inclination: greatest inclination in degrees between vertically adjacent pixels of ground, 0 to 90.
  double inclination_limit_deg = 10.0;
  /// Inclination: beams above this elevation in degrees never see ground. An HDL-64E is left its lowest 51 beams.
  double inclination_top_elevation_deg = -2.0;

  /// Growing: height of the sensor above ground in metres; 0: estimated in each scan.
  double sensor_height_m = 0.0;
  /// Growing: greatest slope of ground in degrees, 0 to 60.
  double slope_deg = 10.0;
  /// Growing: by how many metres the height of a ground return may miss that of the last one in its column, beyond the
  /// slope: roughness and range noise.
  double step_tolerance_m = 0.08;
  /// Growing: by how many metres ground may stand out from a profile that rises no faster than the slope: a kerb. It
  /// keeps ground from climbing a wall by many small steps.
  double profile_tolerance_m = 0.12;
  /// Growing: a ground return is the foot of the next return above it in its column that is no ground where the line
  /// between them is at least as steep as this angle in degrees, 0 to 90; 90: nothing is a foot.
  double foot_angle_deg = 20.0;
  /// Growing: by how many metres that return may be higher than its foot beyond the gap between two beams, 0 to 10. It
  /// keeps ground that is seen under a vehicle or a branch. No more of the height counts for the angle, whatever the
  /// beams: a foot is at most 0.27 m before or behind what it belongs to.
  double foot_height_m = 0.1;
  /// Growing: whether each pixel is compared with its eight neighbours at last.
  bool smooths = true;

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// "growing" or "inclination"
SAW_NDT_EXPORT const char* toString(GroundRule rule);

/// How components of pixels that are no ground are told from noise; the defaults are LeGO-LOAM's.
struct SAW_NDT_EXPORT ComponentOptions {
  /// Neighbours are connected where the line between them makes more than this angle in degrees with the line of sight
  /// to the farther one, above 0 and below 90.
  double connection_angle_deg = 60.0;
  /// A component of this many points or more, all returns of its pixels counted, is kept, at least 1.
  int min_points = 30;
  /// So is a smaller one of this many points or more, at least 1, if it spans enough rings.
  int min_points_tall = 5;
  /// Rings that such a smaller component must span, at least 1.
  int min_rings_tall = 3;

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// Options of ScanSegmenter and RangeImageSegmentation.
struct SAW_NDT_EXPORT SegmentationOptions {
  /// Beams and image width of the sensor.
  SensorModel sensor = SensorModel::named("HDL-64E");
  /// How the sensor is turned out of the horizontal: by the roll about its x axis, then by the pitch, by which that
  /// axis points below the horizon. The heading does not matter: level = Ry(pitch) Rx(roll). Degrees, pitch -90 to 90,
  /// roll -180 to 180; a roll of 180 is a sensor upside down.
  double mounting_pitch_deg = 0.0;
  double mounting_roll_deg = 0.0;
  /// Nearer points are no returns, as those of the vehicle itself (m).
  double min_range_m = 0.0;
  /// Nor are farther ones (m).
  double max_range_m = std::numeric_limits<double>::infinity();
  /// Nor are those in the box of the vehicle itself: least x, y, z, greatest x, y, z in the LiDAR frame (m); empty:
  /// there is none.
  std::vector<double> vehicle_box_m;
  /// How ground is told.
  GroundOptions ground;
  /// What is noise.
  ComponentOptions components;

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// A field in which two options differ.
struct OptionDifference {
  std::string field;   ///< such as "ground.slope_deg"
  std::string first;   ///< its value in the first options
  std::string second;  ///< its value in the second ones
};

/// The first field, in the order of declaration, in which options differ; nothing where they are the same.
SAW_NDT_EXPORT std::optional<OptionDifference> firstDifference(const SegmentationOptions& first,
                                                               const SegmentationOptions& second);

}  // namespace saw_ndt
