#pragma once

#include <functional>

#include "saw_ndt/common/export.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/drives/scan_source.h"
#include "saw_ndt/map/moved_voxels.h"

namespace saw_ndt {

/// Counts what the scans of a source saw through, at their reference poses: the second pass over the scans that a map
/// was built of. Nothing is segmented.
/// @param options    those that the map was built by; resolution and segmentation do not count
/// @param moved      of the map, to which scans of other drives may have been added
/// @param scan_done  called after each scan, from any thread; may be empty
/// @throws Error and std::invalid_argument as buildDriveMap()
SAW_NDT_EXPORT void addScans(ScanSource& scans, const DriveMapOptions& options, MovedVoxels& moved,
                             const std::function<void()>& scan_done = {});

}  // namespace saw_ndt
