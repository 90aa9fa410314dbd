#pragma once

#include <cstdint>
#include <vector>

#include "saw_ndt/segmentation/scan_segmenter.h"
#include "segmentation/component_filter.h"
#include "segmentation/ground_detection.h"
#include "segmentation/ground_grid.h"
#include "segmentation/range_image.h"

namespace saw_ndt::internal {

/// What a ScanSegmenter works with; of the last scan once it has been labelled.
struct SegmentationStages {
  explicit SegmentationStages(const SegmentationOptions& with);

  SegmentationOptions options;
  ScanProjection projection;
  bool on_grid = false;  ///< the sensor has no beams, or lies on its side: scans are segmented on `grid`
  SensorModel sensor;    ///< the beams as the rows of the image are: turned round where the sensor is upside down
  RangeImage image;
  GroundGrid grid;
  GroundDetection ground_detection;
  ComponentFilter component_filter;
  std::vector<std::uint8_t> ground;           ///< 1 for each pixel that is ground, otherwise 0
  std::vector<StructuralLabel> pixel_labels;  ///< of each pixel of `image`
};

}  // namespace saw_ndt::internal
