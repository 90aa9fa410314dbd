#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "map/map_metadata.h"
#include "saw_ndt/map/voxel_weighting.h"

namespace saw_ndt::internal {

/// How the voxels of a localization map were weighted, as lines of its metadata: "weighting.<field> = value".
std::string weightingText(const VoxelWeighting& weighting);

/// Sets what metadata with such lines says. @return a fault where one is missing or malformed, or does not hold
std::optional<MetadataFault> readWeighting(std::string_view text, VoxelWeighting& weighting);

}  // namespace saw_ndt::internal
