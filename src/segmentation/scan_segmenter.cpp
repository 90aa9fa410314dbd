#include "saw_ndt/segmentation/scan_segmenter.h"

#include <algorithm>

#include "common/executor.h"
#include "saw_ndt/common/geometry.h"
#include "segmentation/segmentation_stages.h"

namespace saw_ndt {

using namespace internal;

ScanSegmenter::ScanSegmenter(const SegmentationOptions& options)
    : stages_((options.check(), std::make_unique<internal::SegmentationStages>())) {
  stages_->options = options;
}
ScanSegmenter::~ScanSegmenter() = default;
ScanSegmenter::ScanSegmenter(ScanSegmenter&& other) noexcept = default;
ScanSegmenter& ScanSegmenter::operator=(ScanSegmenter&& other) noexcept = default;

const SegmentationOptions& ScanSegmenter::options() const { return stages_->options; }

void ScanSegmenter::segment(const ScanView& scan, std::vector<StructuralLabel>& labels, int threads) {
  threads = internal::threadCount(threads);
  const internal::HelperSession session(threads);
  internal::SegmentationStages& s = *stages_;
  const SegmentationOptions& options = s.options;
  s.image.project(scan, options.sensor, radiansFromDegrees(options.mounting_pitch_deg), threads);
  s.ground_detection.detect(s.image, options.sensor, options.ground, s.ground);
  s.component_filter.label(s.image, options.sensor, s.ground, options.components, s.pixel_labels, threads);
  labels.resize(scan.size);
  const std::int32_t* const pixel_of_point = s.image.pixelOfPoint().data();
  const StructuralLabel* const pixel_labels = s.pixel_labels.data();
  StructuralLabel* const point_labels = labels.data();
  constexpr std::size_t kPointsAtOnce = 16384;
  internal::forEachChunk(threads, (scan.size + kPointsAtOnce - 1) / kPointsAtOnce, [&](std::size_t chunk, int) {
    const std::size_t end = std::min(scan.size, (chunk + 1) * kPointsAtOnce);
    for (std::size_t i = chunk * kPointsAtOnce; i < end; ++i) {
      const std::int32_t pixel = pixel_of_point[i];
      point_labels[i] = pixel == RangeImage::kNoPixel ? StructuralLabel::NOISE : pixel_labels[pixel];
    }
  });
}

}  // namespace saw_ndt
