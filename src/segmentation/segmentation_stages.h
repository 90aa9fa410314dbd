#pragma once

#include <cstdint>
#include <vector>

#include "saw_ndt/segmentation/scan_segmenter.h"
#include "segmentation/component_filter.h"
#include "segmentation/ground_detection.h"
#include "segmentation/range_image.h"

namespace saw_ndt::internal {

/// What a ScanSegmenter works with; of the last scan once it has been labelled.
struct SegmentationStages {
  SegmentationOptions options;
  RangeImage image;
  GroundDetection ground_detection;
  ComponentFilter component_filter;
  std::vector<std::uint8_t> ground;           ///< 1 for each pixel that is ground, otherwise 0
  std::vector<StructuralLabel> pixel_labels;  ///< of each pixel
};

}  // namespace saw_ndt::internal
