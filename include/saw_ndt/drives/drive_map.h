#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "saw_ndt/io/kitti.h"
#include "saw_ndt/map/weighted_map_builder.h"
#include "saw_ndt/segmentation/scan_segmenter.h"

namespace saw_ndt {

struct SequenceMapOptions {
  double resolution_m = 1.0;                                                ///< edge of a voxel
  std::optional<SegmentationOptions> segmentation = SegmentationOptions();  ///< none: raw points without labels
  int threads = 0;  ///< 0: all cores; the map does not depend on it
};

/// Adds the given scans of a drive, segmented and moved by their reference poses, to a new builder.
/// @param scans      numbers of scans
/// @param scan_done  called after each scan, from any thread; may be empty
/// @throws Error where a file is missing or damaged, the first such scan's
WeightedMapBuilder buildSequenceMap(const KittiSequence& sequence, const std::vector<int>& scans,
                                    const SequenceMapOptions& options, const std::function<void()>& scan_done = {});

}  // namespace saw_ndt
