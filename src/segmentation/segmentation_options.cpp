#include "saw_ndt/segmentation/segmentation_options.h"

#include <algorithm>
#include <utility>

#include "saw_ndt/common/error.h"
#include "segmentation/segmentation_fields.h"

namespace saw_ndt {
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

void SegmentationOptions::check() const {
  sensor.check();
  checkOption(mounting_pitch_deg >= -90.0 && mounting_pitch_deg <= 90.0, "mounting_pitch_deg", mounting_pitch_deg,
              "-90 to 90");
  ground.check();
  components.check();
}

const char* toString(GroundRule rule) { return rule == GroundRule::Growing ? "growing" : "inclination"; }

std::optional<OptionDifference> firstDifference(const SegmentationOptions& first, const SegmentationOptions& second) {
  const Fields first_fields = fieldsOf(first), second_fields = fieldsOf(second);
  const auto [a, b] = std::mismatch(first_fields.begin(), first_fields.end(), second_fields.begin());
  if (a == first_fields.end()) return std::nullopt;
  return OptionDifference{a->first, a->second, b->second};
}

}  // namespace saw_ndt
