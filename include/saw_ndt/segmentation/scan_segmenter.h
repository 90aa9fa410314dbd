#pragma once

#include <cstdint>
#include <vector>

#include "saw_ndt/common/labels.h"
#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/segmentation/segmentation_options.h"
#include "segmentation/component_filter.h"
#include "segmentation/ground_detection.h"
#include "segmentation/range_image.h"

namespace saw_ndt {

/// Range-image segmentation of a scan (section III.A of the paper): the label of every point. It allocates nothing once
/// it has seen a scan as large as the present one. One object per thread.
class ScanSegmenter {
 public:
  /// Throws std::invalid_argument where an option is out of its limits.
  explicit ScanSegmenter(const SegmentationOptions& options = SegmentationOptions());

  const SegmentationOptions& options() const { return options_; }

  /// Writes the label of every point in input order. Points that are not finite, at the sensor's origin or outside of
  /// its field of view are Noise; all points of a pixel have the same label. Labels do not depend on the number of
  /// threads (1 or more).
  void segment(const ScanView& scan, std::vector<StructuralLabel>& labels, int threads = 1);

  /// The image of the last scan, and the label of each of its pixels.
  const RangeImage& rangeImage() const { return image_; }
  const std::vector<StructuralLabel>& pixelLabels() const { return pixel_labels_; }

 private:
  SegmentationOptions options_;
  RangeImage image_;
  GroundDetection ground_detection_;
  ComponentFilter component_filter_;
  std::vector<std::uint8_t> ground_;
  std::vector<StructuralLabel> pixel_labels_;
};

}  // namespace saw_ndt
