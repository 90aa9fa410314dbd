#pragma once

#include <string>

#include "saw_ndt/common/export.h"
#include "saw_ndt/map/localization_map.h"
#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt {

/// Writes the LocalizationMap of a map for one weighting, such as LocalizationMethod::voxels: its voxels quantized to
/// 32 bytes (see docs/maps.md for the bounds), and the tables of GlobalSearch. The file appears once it is whole.
/// @param threads  0: all cores; the file does not depend on it
/// @throws std::invalid_argument where the weighting does not hold or voxels are smaller than a millimetre. Error where
/// the file cannot be written
SAW_NDT_EXPORT void packMap(const WeightedVoxelMap& map, const std::string& localization_map_file,
                            const VoxelWeighting& weighting, int threads = 0);

}  // namespace saw_ndt
