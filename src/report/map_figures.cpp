#include "report/map_figures.h"

#include <type_traits>

#include "segmentation/segmentation_fields.h"

namespace saw_ndt {
namespace {

constexpr char kNotKnown[] = "not known";

}  // namespace

nlohmann::ordered_json vectorFigures(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

nlohmann::ordered_json toJson(const TileEntries& entries) {
  return {{"min", entries.min}, {"median", entries.median}, {"max", entries.max}};
}

std::string orNotKnown(const std::string& text) { return text.empty() ? kNotKnown : text; }

nlohmann::ordered_json classFigures(const std::array<std::size_t, 3>& class_voxels) {
  return withShares({"linear", "planar", "volumetric"}, class_voxels);
}

nlohmann::ordered_json segmentationFigures(const std::optional<SegmentationOptions>& options) {
  if (!options) return kNotKnown;
  nlohmann::ordered_json json;
  internal::forEachField(*options, [&json](const char* name, const auto& value) {
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, GroundRule>) {
      json[name] = toString(value);
    } else {
      json[name] = value;
    }
  });
  return json;
}

}  // namespace saw_ndt
