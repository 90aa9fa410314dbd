#pragma once

#include <cstdint>
#include <vector>

#include "saw_ndt/common/labels.h"
#include "saw_ndt/common/sensor_model.h"
#include "segmentation/component_filter.h"
#include "segmentation/ground_detection.h"
#include "segmentation/range_image.h"
#include "saw_ndt/common/scan_view.h"

namespace saw_ndt {

/// Options of ScanSegmenter and RangeImageSegmentation.
struct SegmentationOptions {
  /// Beams and image width of the sensor.
  SensorModel sensor = SensorModel::named("HDL-64E");
  /// Angle in degrees by which the sensor's x axis points below the horizon, -90 to 90.
  double mounting_pitch_deg = 0.0;
  /// How ground is told.
  GroundOptions ground;
  /// What is noise.
  ComponentOptions components;

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

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
