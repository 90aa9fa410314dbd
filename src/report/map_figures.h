#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "report/map_summary.h"

namespace saw_ndt {

// Members that the summaries of both kinds of maps share.

/// [x, y, z]
nlohmann::ordered_json vectorFigures(const Eigen::Vector3d& v);
/// {"min", "median", "max"}
nlohmann::ordered_json toJson(const TileEntries& entries);
/// The text, or that it is not known.
std::string orNotKnown(const std::string& text);
/// {"linear", "planar", "volumetric", and the share of each}
nlohmann::ordered_json classFigures(const std::array<std::size_t, 3>& class_voxels);
/// {"sensor.name": ..., "sensor.columns": ..., ...}, or that it is not known
nlohmann::ordered_json segmentationFigures(const std::optional<SegmentationOptions>& options);

/// {"<name>": count, ..., "<name>_share": ...}; shares are 0 where there is nothing to share.
template <typename Count>
nlohmann::ordered_json withShares(const std::array<const char*, 3>& names, const std::array<Count, 3>& counts) {
  nlohmann::ordered_json counted, shares;
  double total = 0.0;
  for (const Count count : counts) total += static_cast<double>(count);
  for (std::size_t i = 0; i < names.size(); ++i) {
    counted[names[i]] = counts[i];
    shares[std::string(names[i]) + "_share"] = total > 0.0 ? static_cast<double>(counts[i]) / total : 0.0;
  }
  counted.update(shares);
  return counted;
}

}  // namespace saw_ndt
