#include "segmentation/segmentation_fields.h"

#include <charconv>
#include <system_error>

namespace saw_ndt::internal {
namespace {

template <typename Number>
std::string numberText(Number value) {
  char text[64];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

template <typename Number>
bool parseNumber(std::string_view text, Number& value) {
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end;
}

}  // namespace

std::string fieldText(const std::string& value) { return value; }
std::string fieldText(int value) { return numberText(value); }
std::string fieldText(double value) { return numberText(value); }
std::string fieldText(bool value) { return value ? "true" : "false"; }
std::string fieldText(GroundRule value) { return toString(value); }
std::string fieldText(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : " ") + fieldText(value);
  return text;
}

bool parseField(std::string_view text, std::string& value) {
  value = text;
  return true;
}
bool parseField(std::string_view text, int& value) { return parseNumber(text, value); }
bool parseField(std::string_view text, double& value) { return parseNumber(text, value); }
bool parseField(std::string_view text, bool& value) {
  value = text == "true";
  return value || text == "false";
}
bool parseField(std::string_view text, GroundRule& value) {
  for (const GroundRule rule : {GroundRule::INCLINATION, GroundRule::GROWING}) {
    if (text != toString(rule)) continue;
    value = rule;
    return true;
  }
  return false;
}
bool parseField(std::string_view text, std::vector<double>& values) {
  values.clear();
  if (text.empty()) return true;
  while (true) {
    const std::size_t space = text.find(' ');
    if (!parseField(text.substr(0, space), values.emplace_back())) return false;
    if (space == std::string_view::npos) return true;
    text.remove_prefix(space + 1);
  }
}

SegmentationOptions mountedAs(SegmentationOptions options, const SegmentationOptions& other) {
  options.mounting_pitch_deg = other.mounting_pitch_deg;
  options.mounting_roll_deg = other.mounting_roll_deg;
  options.min_range_m = other.min_range_m;
  options.max_range_m = other.max_range_m;
  options.vehicle_box_m = other.vehicle_box_m;
  options.ground.sensor_height_m = other.ground.sensor_height_m;
  return options;
}

}  // namespace saw_ndt::internal
