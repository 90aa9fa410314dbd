#include "saw_ndt/segmentation/segmentation_options.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "saw_ndt/common/error.h"
#include "segmentation/segmentation_fields.h"

namespace saw_ndt {

using namespace internal;

namespace {

using Fields = std::vector<std::pair<std::string, std::string>>;

Fields fieldsOf(const SegmentationOptions& options) {
  Fields fields;
  internal::forEachField(options, [&fields](const char* name, const auto& value) {
    fields.emplace_back(name, internal::fieldText(value));
  });
  return fields;
}

}  // namespace

void GroundOptions::check() const {
  const auto in = [](double value, double least, double greatest) { return value >= least && value <= greatest; };
  checkOption(in(inclination_limit_deg, 0.0, 90.0), "inclination_limit_deg", inclination_limit_deg, "0 to 90");
  checkOption(in(inclination_top_elevation_deg, -90.0, 90.0), "inclination_top_elevation_deg",
              inclination_top_elevation_deg, "-90 to 90");
  checkOption(in(sensor_height_m, 0.0, 100.0), "sensor_height_m", sensor_height_m, "0 to 100");
  checkOption(in(slope_deg, 0.0, 60.0), "slope_deg", slope_deg, "0 to 60");
  checkOption(in(step_tolerance_m, 0.0, 10.0), "step_tolerance_m", step_tolerance_m, "0 to 10");
  checkOption(in(profile_tolerance_m, 0.0, 10.0), "profile_tolerance_m", profile_tolerance_m, "0 to 10");
  checkOption(in(foot_angle_deg, 0.0, 90.0), "foot_angle_deg", foot_angle_deg, "0 to 90");
  checkOption(in(foot_height_m, 0.0, 10.0), "foot_height_m", foot_height_m, "0 to 10");
}

void ComponentOptions::check() const {
  checkOption(connection_angle_deg > 0.0 && connection_angle_deg < 90.0, "connection_angle_deg", connection_angle_deg,
              "above 0 and below 90");
  checkOption(min_points >= 1, "min_points", min_points, "at least 1");
  checkOption(min_points_tall >= 1, "min_points_tall", min_points_tall, "at least 1");
  checkOption(min_rings_tall >= 1, "min_rings_tall", min_rings_tall, "at least 1");
}

void SegmentationOptions::check() const {
  sensor.check();
  checkOption(mounting_pitch_deg >= -90.0 && mounting_pitch_deg <= 90.0, "mounting_pitch_deg", mounting_pitch_deg,
              "-90 to 90");
  checkOption(mounting_roll_deg >= -180.0 && mounting_roll_deg <= 180.0, "mounting_roll_deg", mounting_roll_deg,
              "-180 to 180");
  checkOption(min_range_m >= 0.0 && std::isfinite(min_range_m), "min_range_m", min_range_m, "0 or more");
  checkOption(max_range_m > min_range_m, "max_range_m", max_range_m, "greater than min_range_m");
  checkOption(vehicle_box_m.empty() || vehicle_box_m.size() == 6, "vehicle_box_m.size()", vehicle_box_m.size(),
              "6 numbers or none");
  for (std::size_t i = 0; i < vehicle_box_m.size(); ++i) {
    const double value = vehicle_box_m[i];
    checkOption(std::isfinite(value) && (i < 3 || value >= vehicle_box_m[i - 3]), "vehicle_box_m", value,
                "least x, y, z, then greatest x, y, z");
  }
  ground.check();
  components.check();
}

const char* toString(GroundRule rule) { return rule == GroundRule::GROWING ? "growing" : "inclination"; }

std::optional<OptionDifference> firstDifference(const SegmentationOptions& first, const SegmentationOptions& second) {
  const Fields first_fields = fieldsOf(first), second_fields = fieldsOf(second);
  const auto [a, b] = std::mismatch(first_fields.begin(), first_fields.end(), second_fields.begin());
  if (a == first_fields.end()) return std::nullopt;
  return OptionDifference{a->first, a->second, b->second};
}

}  // namespace saw_ndt
