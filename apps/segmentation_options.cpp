#include "segmentation_options.h"

#include <algorithm>
#include <iomanip>
#include <iostream>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "report/sensor_model_file.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/segmentation/sensor_setup.h"

namespace saw_ndt {
namespace {

constexpr char kAuto[] = "auto";

// The map's model where the beams are the same but for what a few scans tell of them.
bool areAlike(const SensorModel& a, const SensorModel& b) {
  constexpr double kSameBeam_deg = 0.5;
  return std::equal(a.elevations_deg.begin(), a.elevations_deg.end(), b.elevations_deg.begin(), b.elevations_deg.end(),
                    [](double x, double y) { return std::abs(x - y) < kSameBeam_deg; });
}

std::string mountingText(const SegmentationOptions& options, const std::optional<LearnedMounting>& seen) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(1);
  if (options.mounting_pitch_deg == 0.0 && options.mounting_roll_deg == 0.0) {
    text << "level";
  } else {
    text << "pitch " << options.mounting_pitch_deg << " and roll " << options.mounting_roll_deg << " degrees";
  }
  const double height_m =
      options.ground.sensor_height_m > 0.0 ? options.ground.sensor_height_m : seen.value_or(LearnedMounting()).height_m;
  if (height_m > 0.0) text << ", " << std::setprecision(2) << height_m << " m above the ground";
  return text.str();
}

std::string sensorText(const LearnedSensor& sensor) {
  if (sensor.model.rows() == 0) return "no rings: a grid around the sensor is segmented instead of a range image";
  return sensor.model.name + ", told by " + sensor.evidence;
}

std::string sensorNames() {
  std::string names;
  for (const std::string& name : SensorModel::names()) names += (names.empty() ? "" : ", ") + name;
  return names;
}

std::string optionsFor(SegmentationDoubt::Cause cause) {
  switch (cause) {
    case SegmentationDoubt::Cause::SENSOR:
      return "-sensor";
    case SegmentationDoubt::Cause::MOUNTING:
      return "-mounting auto, or -mounting-pitch-deg and -mounting-roll-deg";
    case SegmentationDoubt::Cause::HEIGHT:
      return "-sensor-height";
    case SegmentationDoubt::Cause::NO_RETURN:
      return "-min-range, -max-range and -vehicle-box";
  }
  return {};
}

}  // namespace

void SegmentationArguments::addTo(AppOptions& app) {
  app_ = &app;
  sensor_ = mounting_ = kAuto;
  ground_rule_ = toString(values_.ground.rule);
  app.addOption("sensor", &sensor_, "NAME|FILE.json",
                "beams and image width of the LiDAR: `auto` learns them from the first scans; a file like those of "
                "share/saw_ndt/sensors; or one of " +
                    sensorNames());
  app.addChoice("mounting", &mounting_, {kAuto, "stated"},
                "auto learns from the ground of the first scans how the LiDAR leans and how high it is, as far as the "
                "options below do not state it");
  app.addOption("mounting-pitch-deg", &values_.mounting_pitch_deg, "DEGREES",
                "angle by which the LiDAR's x axis points below the horizon");
  app.addOption("mounting-roll-deg", &values_.mounting_roll_deg, "DEGREES",
                "angle by which the LiDAR is turned about its x axis before, 180 for upside down");
  app.addOption("sensor-height", &values_.ground.sensor_height_m, "METRES",
                "of the LiDAR above the ground; 0: from the scans");
  app.addOption("min-range", &values_.min_range_m, "METRES", "nearer points are no returns");
  app.addOption("max-range", &max_range_m_, "METRES", "farther points are no returns; 0 for any");
  app.addOption(
      "vehicle-box", &values_.vehicle_box_m, "X,Y,Z,X,Y,Z",
      "least, then greatest corner of a box around the vehicle in the LiDAR frame, metres, whose points are no "
      "returns (default: none)");
  app.addChoice("ground-rule", &ground_rule_, {toString(GroundRule::GROWING), toString(GroundRule::INCLINATION)},
                "how ground is told: growing follows it outward column by column, inclination is the paper's rule");
  app.addOption("slope-deg", &values_.ground.slope_deg, "DEGREES",
                "greatest slope of the ground; more where it is not stated and the first scans show steeper ground");
}

bool SegmentationArguments::learnsSensor() const { return sensor_ == kAuto; }
bool SegmentationArguments::learnsMounting() const { return mounting_ == kAuto; }

SegmentationOptions SegmentationArguments::stated() const {
  SegmentationOptions options = values_;
  options.ground.rule =
      ground_rule_ == toString(GroundRule::INCLINATION) ? GroundRule::INCLINATION : GroundRule::GROWING;
  options.max_range_m = max_range_m_ == 0.0 ? std::numeric_limits<double>::infinity() : max_range_m_;
  try {
    if (!learnsSensor()) options.sensor = sensorModelOf(sensor_);
  } catch (const std::invalid_argument&) {
    throw UsageError("option -sensor: '" + sensor_ + "' is none of auto, FILE.json, " + sensorNames());
  }
  checkedUsage([&] { options.check(); });
  return options;
}

SegmentationOptions SegmentationArguments::learnedFrom(const std::vector<ScanPoints>& scans,
                                                       const Knowledge& knowledge) const {
  SegmentationOptions options = stated();
  std::vector<ScanView> views;
  for (const ScanPoints& scan : scans) {
    if (!scan.points.empty()) views.push_back(viewOf(scan));
  }
  const bool has_angles = app_->isGiven("mounting-pitch-deg") || app_->isGiven("mounting-roll-deg");
  const bool has_base = !has_angles && !knowledge.R_base_lidar.isIdentity();
  if (has_base) {
    // R_base_lidar = Rz Ry(pitch) Rx(roll): the heading does not matter.
    const Eigen::RowVector3d up = knowledge.R_base_lidar.row(2);
    options.mounting_pitch_deg = degreesFromRadians(std::asin(std::clamp(-up.x(), -1.0, 1.0)));
    options.mounting_roll_deg = degreesFromRadians(std::atan2(up.y(), up.z()));
  }
  if (knowledge.of_map) {
    // What is not stated is as it was for the map.
    const GroundOptions given = options.ground;
    options.ground = knowledge.of_map->ground;
    options.components = knowledge.of_map->components;
    options.ground.sensor_height_m = given.sensor_height_m;
    if (app_->isGiven("ground-rule")) options.ground.rule = given.rule;
    if (app_->isGiven("slope-deg")) options.ground.slope_deg = given.slope_deg;
  }
  if (views.empty()) return options;

  std::string sensor_text = options.sensor.name;
  if (learnsSensor()) {
    LearnedSensor learned = learnSensor(views);
    sensor_text = sensorText(learned);
    if (knowledge.of_map && areAlike(learned.model, knowledge.of_map->sensor)) learned.model = knowledge.of_map->sensor;
    options.sensor = learned.model;
  }
  std::optional<LearnedMounting> mounting;
  bool is_mounted_otherwise = false;
  if (learnsMounting() && (mounting = learnMounting(views))) {
    LearnedMounting stated_first = *mounting;
    if (has_angles || has_base) {
      stated_first.pitch_deg = options.mounting_pitch_deg;
      stated_first.roll_deg = options.mounting_roll_deg;
    }
    const SegmentationOptions before = options;
    options = withMounting(options, stated_first, views.front());
    is_mounted_otherwise = firstDifference(before, options).has_value();
  }
  const double slope_deg = options.ground.slope_deg;
  const bool has_slope = app_->isGiven("slope-deg") || knowledge.of_map;
  if (!has_slope && options.ground.rule == GroundRule::GROWING) options = withSlope(options, views);
  const bool is_steeper = options.ground.slope_deg != slope_deg;
  if (learnsSensor() || is_mounted_otherwise || is_steeper) {
    std::cerr << app_->name() << ": sensor: " << sensor_text << "; mounting: " << mountingText(options, mounting);
    if (is_steeper) std::cerr << "; slopes up to " << options.ground.slope_deg << " degrees";
    std::cerr << '\n';
  }
  for (const SegmentationDoubt& doubt : segmentationDoubts(views.front(), options)) {
    warn(*app_, doubt.seen + "; see " + optionsFor(doubt.cause));
  }
  return options;
}

std::vector<ScanPoints> firstScans(ScanSource& source) {
  std::vector<ScanPoints> scans;
  RecordedScan scan;
  for (std::size_t read = 0; read < kFirstScans && source.next(scan); ++read) {
    if (scan.failure.empty()) scans.push_back(std::move(scan));
  }
  return scans;
}

}  // namespace saw_ndt
