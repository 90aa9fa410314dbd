#include "map/map_metadata.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "map/metadata_lines.h"
#include "segmentation/segmentation_fields.h"

namespace saw_ndt::internal {
namespace {

constexpr char kVersionKey[] = "software_version";
constexpr char kSegmentationKey[] = "segmentation";
constexpr char kKnown[] = "known";
constexpr char kNone[] = "none";
// Options that older files of version 2 do not have. Before there were feet, nothing was one.
constexpr std::string_view kFootAngleKey = "ground.foot_angle_deg";
constexpr std::string_view kLaterKeys[] = {kFootAngleKey, "ground.foot_height_m", "mounting_roll_deg",
                                           "min_range_m", "max_range_m",          "vehicle_box_m"};
constexpr double kNoFeetAngleDeg = 90.0;

}  // namespace

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
  return text;
}

std::optional<MetadataFault> readMetadata(std::string_view text, MapOrigin& origin) {
  MetadataLines lines(text);
  if (lines.fault()) return lines.fault();
  std::string segmentation;
  lines.read(kVersionKey, origin.software_version);
  lines.read(kSegmentationKey, segmentation);
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
