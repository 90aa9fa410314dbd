#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/segmentation/segmentation_options.h"

namespace saw_ndt::internal {

/// Calls visit(name, field) for every field of the options, in the order of declaration.
/// @tparam Options  SegmentationOptions, const or not
template <typename Options, typename Visit>
void forEachField(Options& options, const Visit& visit) {
  visit("sensor.name", options.sensor.name);
  visit("sensor.columns", options.sensor.columns);
  visit("sensor.elevations_deg", options.sensor.elevations_deg);
  visit("mounting_pitch_deg", options.mounting_pitch_deg);
  visit("mounting_roll_deg", options.mounting_roll_deg);
  visit("min_range_m", options.min_range_m);
  visit("max_range_m", options.max_range_m);
  visit("vehicle_box_m", options.vehicle_box_m);
  visit("ground.rule", options.ground.rule);
  visit("ground.inclination_limit_deg", options.ground.inclination_limit_deg);
  visit("ground.inclination_top_elevation_deg", options.ground.inclination_top_elevation_deg);
  visit("ground.sensor_height_m", options.ground.sensor_height_m);
  visit("ground.slope_deg", options.ground.slope_deg);
  visit("ground.step_tolerance_m", options.ground.step_tolerance_m);
  visit("ground.profile_tolerance_m", options.ground.profile_tolerance_m);
  visit("ground.foot_angle_deg", options.ground.foot_angle_deg);
  visit("ground.foot_height_m", options.ground.foot_height_m);
  visit("ground.smooths", options.ground.smooths);
  visit("components.connection_angle_deg", options.components.connection_angle_deg);
  visit("components.min_points", options.components.min_points);
  visit("components.min_points_tall", options.components.min_points_tall);
  visit("components.min_rings_tall", options.components.min_rings_tall);
}

/// A field's value as text from which parseField() makes the same value, bit for bit. Several numbers stand apart by
/// spaces.
std::string fieldText(const std::string& value);
std::string fieldText(int value);
std::string fieldText(double value);
std::string fieldText(bool value);
std::string fieldText(GroundRule value);
std::string fieldText(const std::vector<double>& values);

/// Reads a field from the whole of a text; false where it is none, and the field is then unspecified.
bool parseField(std::string_view text, std::string& value);
bool parseField(std::string_view text, int& value);
bool parseField(std::string_view text, double& value);
bool parseField(std::string_view text, bool& value);
bool parseField(std::string_view text, GroundRule& value);
bool parseField(std::string_view text, std::vector<double>& values);

/// Options with the mounting, the ranges and the vehicle's box of others: of a map of another vehicle, where its LiDAR
/// was and what of it was seen does not matter.
SAW_NDT_EXPORT SegmentationOptions mountedAs(SegmentationOptions options, const SegmentationOptions& other);

}  // namespace saw_ndt::internal
