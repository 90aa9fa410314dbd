#include "map/map_metadata.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <vector>

#include "map/metadata_lines.h"
#include "segmentation/segmentation_fields.h"

namespace saw_ndt::internal {
namespace {

constexpr char kVersionKey[] = "software_version";
constexpr char kSegmentationKey[] = "segmentation";
constexpr char kMapOriginKey[] = "map_origin_m";
constexpr char kKnown[] = "known";
constexpr char kNone[] = "none";
// Options that older files of version 2 do not have. Before there were feet, nothing was one.
constexpr std::string_view kFootAngleKey = "ground.foot_angle_deg";
constexpr std::string_view kLaterKeys[] = {kFootAngleKey, "ground.foot_height_m", "mounting_roll_deg",
                                           "min_range_m", "max_range_m",          "vehicle_box_m"};
constexpr double kNoFeetAngleDeg = 90.0;

void readMapOrigin(MetadataLines& lines, Eigen::Vector3d& map_origin_m) {
  std::vector<double> numbers;
  lines.read(kMapOriginKey, numbers);
  if (lines.fault()) return;
  const bool valid = numbers.size() == 3 && Eigen::Map<const Eigen::Vector3d>(numbers.data()).allFinite();
  if (!valid) return lines.failAt(kMapOriginKey, "damaged: the metadata gives no valid map_origin_m");
  map_origin_m = Eigen::Map<const Eigen::Vector3d>(numbers.data());
}

}  // namespace

std::string positionText(const Eigen::Vector3d& position) {
  return fieldText(std::vector<double>(position.data(), position.data() + 3));
}

std::string metadataText(const MapOrigin& origin) {
  std::string text;
  const auto write = [&text](const std::string& key, const std::string& value) {
    appendMetadataLine(key, value, text);
  };
  write(kVersionKey, origin.software_version);
  write(kSegmentationKey, origin.segmentation ? kKnown : kNone);
  if (origin.segmentation) {
    forEachField(*origin.segmentation, [&](const char* name, const auto& value) { write(name, fieldText(value)); });
  }
  if (!origin.map_origin_m.isZero(0.0)) write(kMapOriginKey, positionText(origin.map_origin_m));
  return text;
}

std::optional<MetadataFault> readMetadata(std::string_view text, MapOrigin& origin) {
  MetadataLines lines(text);
  if (lines.fault()) return lines.fault();
  std::string segmentation;
  lines.read(kVersionKey, origin.software_version);
  lines.read(kSegmentationKey, segmentation);
  if (lines.gives(kMapOriginKey)) readMapOrigin(lines, origin.map_origin_m);
  if (lines.fault() || segmentation == kNone) return lines.fault();
  if (segmentation != kKnown) {
    lines.failAt(kSegmentationKey, "damaged: the metadata gives no valid segmentation");
    return lines.fault();
  }
  SegmentationOptions options;
  if (!lines.gives(kFootAngleKey)) options.ground.foot_angle_deg = kNoFeetAngleDeg;
  forEachField(options, [&](const std::string_view name, auto& value) {
    const bool may_lack = std::find(std::begin(kLaterKeys), std::end(kLaterKeys), name) != std::end(kLaterKeys);
    if (may_lack && !lines.gives(name)) return;
    lines.read(name, value);
  });
  try {
    if (!lines.fault()) options.check();
  } catch (const std::invalid_argument& error) {
    lines.fail(0, std::string("damaged: the metadata gives ") + error.what());
  }
  if (!lines.fault()) origin.segmentation = options;
  return lines.fault();
}

}  // namespace saw_ndt::internal
