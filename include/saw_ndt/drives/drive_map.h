#pragma once

#include <functional>
#include <optional>
#include <string>

#include "saw_ndt/common/export.h"
#include "saw_ndt/drives/scan_source.h"
#include "saw_ndt/map/weighted_map_builder.h"
#include "saw_ndt/segmentation/scan_segmenter.h"

namespace saw_ndt {

struct DriveMapOptions {
  /// Edge of a voxel: of the smallest that `weighted` can match; the paper's methods put voxels of 1 m together.
  double resolution_m = 0.5;
  std::optional<SegmentationOptions> segmentation = SegmentationOptions();  ///< none: raw points without labels
  int threads = 0;  ///< 0: all cores; the map does not depend on it
  /// Called with the reason of each scan that could not be read, in order and from any thread: it is left out. None:
  /// such a scan is an error.
  std::function<void(const std::string& failure)> scan_left_out;
};

/// Adds the scans of a source, segmented and moved by their reference poses, to a new builder.
/// @param scan_done  called after each scan, from any thread; may be empty
/// @throws Error where a scan cannot be read (see scan_left_out) or has no reference pose, the first such scan's; where
///         none of several scans could be read
SAW_NDT_EXPORT WeightedMapBuilder buildDriveMap(ScanSource& scans, const DriveMapOptions& options,
                                                const std::function<void()>& scan_done = {});

}  // namespace saw_ndt
