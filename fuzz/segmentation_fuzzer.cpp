#include <cmath>
#include <stdexcept>

#include "fuzzed_clouds.h"
#include "fuzzed_file.h"
#include "saw_ndt/segmentation/scan_segmenter.h"
#include "saw_ndt/segmentation/sensor_setup.h"

namespace saw_ndt {
namespace {

/// A LiDAR of few beams and columns, so that images are small; of rows in any order.
SensorModel smallSensor(std::uint8_t form) {
  SensorModel sensor = SensorModel::named(form % 4 == 0 ? "no-rings" : "VLP-16");
  sensor.columns = form % 4 == 1 ? 360 : 128;
  return sensor;
}

SegmentationOptions anyOptions(FuzzedDataProvider& provider) {
  SegmentationOptions options;
  options.sensor = smallSensor(provider.ConsumeIntegral<std::uint8_t>());
  if (provider.ConsumeBool()) return options;
  options.mounting_pitch_deg = static_cast<double>(anyFloat(provider, 0.01F));
  options.mounting_roll_deg = static_cast<double>(anyFloat(provider, 0.01F));
  options.min_range_m = static_cast<double>(anyFloat(provider, 0.001F));
  options.ground.rule = provider.ConsumeBool() ? GroundRule::GROWING : GroundRule::INCLINATION;
  options.ground.sensor_height_m = static_cast<double>(anyFloat(provider, 0.001F));
  options.ground.slope_deg = provider.ConsumeIntegral<std::uint8_t>();
  options.components.min_points = provider.ConsumeIntegral<std::int8_t>();
  if (provider.ConsumeBool()) options.vehicle_box_m = {-2.0, -1.0, -2.0, 1.0, 1.0, 0.2};
  return options;
}

}  // namespace
}  // namespace saw_ndt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace saw_ndt;
  FuzzedDataProvider provider(data, size);
  const SegmentationOptions options = anyOptions(provider);
  const ScanPoints scan = anyScan(provider);
  try {
    options.check();
  } catch (const std::invalid_argument&) {
    return 0;
  }
  ScanSegmenter segmenter(options);
  std::vector<StructuralLabel> labels, again;
  try {
    segmenter.segment(viewOf(scan), labels);
  } catch (const std::invalid_argument&) {
    require(!scan.rings.empty() || scan.height > 1, "only rings and rows may be such as the sensor has not");
    return 0;
  }
  segmenter.segment(viewOf(scan), again);
  require(labels.size() == scan.points.size(), "there is a label for each point");
  require(labels == again, "labels do not depend on the scan before");
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const LidarPoint& point = scan.points[i];
    require(labels[i] <= StructuralLabel::NON_GROUND, "labels are among those defined");
    require(std::isfinite(point.x + point.y + point.z) || labels[i] == StructuralLabel::NOISE,
            "what is not finite is noise");
  }
  return 0;
}
