#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "saw_ndt/common/export.h"
#include "saw_ndt/map/localization_map.h"

namespace saw_ndt {

/// Writes the LocalizationMap of a map file for one weighting, such as LocalizationMethod::voxels: its voxels quantized
/// to 32 bytes (docs/localization_map.md has the bounds), and the tables of GlobalSearch. It works through the map
/// block by block of 256 m, so that memory does not grow with the map. The file appears once it is whole.
/// @param threads   0: all cores; the file does not depend on it
/// @param progress  called with the blocks that are done, and how many there are; may be empty
/// @throws std::invalid_argument where the weighting does not hold. Error where the map is missing or damaged or has
/// voxels smaller than a millimetre, where its voxels lie more than 65,535 above each other, and where the file cannot
/// be written
SAW_NDT_EXPORT void packMap(const std::string& map_file, const std::string& localization_map_file,
                            const VoxelWeighting& weighting, int threads = 0,
                            const std::function<void(std::size_t done, std::size_t of)>& progress = {});

}  // namespace saw_ndt
