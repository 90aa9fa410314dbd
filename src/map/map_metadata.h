#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>

#include "saw_ndt/common/export.h"
#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt::internal {

/// How a map was made, as the lines of text that a map file holds: "key = value", each with a line end.
///
///   software_version = 0.1.0    empty where it is not known
///   segmentation = known        or none; with `known` every field of SegmentationOptions follows, under its name
///   map_origin_m = 5000 0 0     only where it is not zero
SAW_NDT_EXPORT std::string metadataText(const MapOrigin& origin);

/// What is wrong with such a text, and where (bytes from its beginning).
struct MetadataFault {
  std::size_t offset = 0;
  std::string reason;
};

/// Sets what a text of metadataText() says. Unknown keys, which a later version may write, are passed over.
/// @return a fault where a known key is missing, given twice or malformed
SAW_NDT_EXPORT std::optional<MetadataFault> readMetadata(std::string_view text, MapOrigin& origin);

/// x, y and z apart by spaces, to the last bit.
std::string positionText(const Eigen::Vector3d& position);

}  // namespace saw_ndt::internal
