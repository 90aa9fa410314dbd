#include "segmentation_options.h"

namespace saw_ndt {

void SegmentationArguments::addTo(AppOptions& app) {
  app.addChoice("sensor", &sensor_, SensorModel::names(), "beams and image width of the LiDAR");
  app.addChoice("ground-rule", &ground_rule_, {"growing", "inclination"},
                "how ground is told: growing follows it outward column by column, inclination is the paper's rule");
  app.addOption("mounting-pitch-deg", &mounting_pitch_deg_, "DEGREES",
                "angle by which the LiDAR's x axis points below the horizon");
}

SegmentationOptions SegmentationArguments::options() const {
  SegmentationOptions options;
  options.sensor = SensorModel::named(sensor_);
  options.ground.rule = ground_rule_ == toString(GroundRule::GROWING) ? GroundRule::GROWING : GroundRule::INCLINATION;
  options.mounting_pitch_deg = mounting_pitch_deg_;
  checkedUsage([&] { options.check(); });
  return options;
}

}  // namespace saw_ndt
