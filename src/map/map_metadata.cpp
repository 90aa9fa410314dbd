#include "map/map_metadata.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <stdexcept>

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
constexpr std::string_view kBetween = " = ";

// The values of a text by their keys.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {
    for (std::size_t start = 0; start < text.size();) {
      const std::size_t end = text.find('\n', start);
      const std::string_view line = text.substr(start, end - start);
      const std::size_t between = line.find(kBetween);
      if (end == std::string_view::npos || between == std::string_view::npos) {
        fail(start, "damaged: the metadata has a line that is not `key = value`");
        return;
      }
      const std::string_view key = line.substr(0, between);
      if (!values_.emplace(key, line.substr(between + kBetween.size())).second) {
        fail(start, "damaged: the metadata gives " + std::string(key) + " twice");
        return;
      }
      start = end + 1;
    }
  }

  template <typename Value>
  void read(std::string_view key, Value& value) {
    const auto found = values_.find(key);
    if (found == values_.end()) {
      fail(0, "damaged: the metadata does not give " + std::string(key));
    } else if (!parseField(found->second, value)) {
      failAt(key, "damaged: the metadata gives no valid " + std::string(key));
    }
  }

  bool gives(std::string_view key) const { return values_.count(key) != 0; }

  void failAt(std::string_view key, const std::string& reason) {
    fail(static_cast<std::size_t>(values_.at(key).data() - text_.data()), reason);
  }
  // The first fault is kept.
  void fail(std::size_t offset, const std::string& reason) {
    if (!fault_) fault_ = MetadataFault{offset, reason};
  }
  const std::optional<MetadataFault>& fault() const { return fault_; }

 private:
  std::string_view text_;
  std::map<std::string_view, std::string_view> values_;
  std::optional<MetadataFault> fault_;
};

}  // namespace

std::string metadataText(const MapOrigin& origin) {
  std::string text;
  const auto write = [&text](const std::string& key, const std::string& value) {
    text.append(key).append(kBetween).append(value).append("\n");
  };
  write(kVersionKey, origin.software_version);
  write(kSegmentationKey, origin.segmentation ? kKnown : kNone);
  if (origin.segmentation) {
    forEachField(*origin.segmentation, [&](const char* name, const auto& value) { write(name, fieldText(value)); });
  }
  return text;
}

std::optional<MetadataFault> readMetadata(std::string_view text, MapOrigin& origin) {
  Lines lines(text);
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
