#include "saw_ndt/segmentation/scan_segmenter.h"

#include <algorithm>

#include "saw_ndt/common/geometry.h"

namespace saw_ndt {

ScanSegmenter::ScanSegmenter(const SegmentationOptions& options) : options_(options) { options_.check(); }

void ScanSegmenter::segment(const ScanView& scan, std::vector<StructuralLabel>& labels, int threads) {
  threads = std::max(threads, 1);
  image_.project(scan, options_.sensor, radiansFromDegrees(options_.mounting_pitch_deg), threads);
  ground_detection_.detect(image_, options_.sensor, options_.ground, ground_, threads);
  component_filter_.label(image_, options_.sensor, ground_, options_.components, pixel_labels_, threads);
  labels.resize(scan.size);
  const auto points = static_cast<std::ptrdiff_t>(scan.size);
  const std::int32_t* const pixel_of_point = image_.pixelOfPoint().data();
  const StructuralLabel* const pixel_labels = pixel_labels_.data();
  StructuralLabel* const point_labels = labels.data();
#pragma omp parallel for num_threads(threads) schedule(static)
  for (std::ptrdiff_t i = 0; i < points; ++i) {
    const std::int32_t pixel = pixel_of_point[i];
    point_labels[i] = pixel == RangeImage::kNoPixel ? StructuralLabel::Noise : pixel_labels[pixel];
  }
}

}  // namespace saw_ndt
