#include "saw_ndt/segmentation/scan_segmenter.h"

#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {

void SegmentationOptions::check() const {
  sensor.check();
  checkOption(mounting_pitch_deg >= -90.0 && mounting_pitch_deg <= 90.0, "mounting_pitch_deg", mounting_pitch_deg,
              "-90 to 90");
  ground.check();
  components.check();
}

ScanSegmenter::ScanSegmenter(const SegmentationOptions& options) : options_(options) { options_.check(); }

void ScanSegmenter::segment(const ScanView& scan, std::vector<StructuralLabel>& labels) {
  image_.project(scan, options_.sensor, radiansFromDegrees(options_.mounting_pitch_deg));
  ground_detection_.detect(image_, options_.sensor, options_.ground, ground_);
  component_filter_.label(image_, options_.sensor, ground_, options_.components, pixel_labels_);
  labels.resize(scan.size);
  const std::vector<std::int32_t>& pixel_of_point = image_.pixelOfPoint();
  for (std::size_t i = 0; i < scan.size; ++i) {
    const std::int32_t pixel = pixel_of_point[i];
    labels[i] = pixel == RangeImage::kNoPixel ? StructuralLabel::Noise : pixel_labels_[pixel];
  }
}

}  // namespace saw_ndt
