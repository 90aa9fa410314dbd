#pragma once

#include <filesystem>
#include <memory>

#include "saw_ndt/common/export.h"
#include "saw_ndt/drives/live_source.h"

namespace saw_ndt::internal {

/// Follows a folder into which .pcd, .ply or .bin files are written or moved: each is a scan once its writer has closed
/// it. Those that are there already are the first ones that come. A scan's stamp is its name, where that is one, else
/// the time of its last change. Scans are numbered as they come.
/// @param bin_fields   see readScanPoints()
/// @param max_waiting  see LiveSource
/// @throws Error where there is no such folder, or where it cannot be watched
SAW_NDT_EXPORT std::unique_ptr<LiveSource> followFolder(const std::filesystem::path& folder, int bin_fields,
                                                        std::size_t max_waiting);

}  // namespace saw_ndt::internal
