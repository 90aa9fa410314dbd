#include "saw_ndt/segmentation/scan_segmenter.h"

#include <algorithm>

#include "common/executor.h"
#include "segmentation/segmentation_stages.h"

namespace saw_ndt {

using namespace internal;

namespace {

void segmentOnGrid(const ScanView& scan, SegmentationStages& stages, std::vector<StructuralLabel>& labels) {
  stages.grid.project(scan, stages.projection);
  // Ground can only be followed here, and what is upright in a cell is told by its points.
  GroundOptions growing = stages.options.ground;
  growing.rule = GroundRule::GROWING;
  growing.foot_angle_deg = 90.0;
  stages.ground_detection.detect(stages.grid, stages.sensor, growing, stages.ground);
  stages.grid.label(stages.ground, stages.options, labels);
}

}  // namespace

internal::SegmentationStages::SegmentationStages(const SegmentationOptions& with)
    : options(with),
      projection(with),
      on_grid(with.sensor.rows() == 0 || projection.liesOnItsSide()),
      sensor(with.sensor) {
  if (!projection.isUpsideDown()) return;
  std::reverse(sensor.elevations_deg.begin(), sensor.elevations_deg.end());
  for (double& elevation_deg : sensor.elevations_deg) elevation_deg = -elevation_deg;
}

ScanSegmenter::ScanSegmenter(const SegmentationOptions& options)
    : stages_((options.check(), std::make_unique<internal::SegmentationStages>(options))) {}
ScanSegmenter::~ScanSegmenter() = default;
ScanSegmenter::ScanSegmenter(ScanSegmenter&& other) noexcept = default;
ScanSegmenter& ScanSegmenter::operator=(ScanSegmenter&& other) noexcept = default;

const SegmentationOptions& ScanSegmenter::options() const { return stages_->options; }

void ScanSegmenter::segment(const ScanView& scan, std::vector<StructuralLabel>& labels, int threads) {
  threads = internal::threadCount(threads);
  const internal::HelperSession session(threads);
  internal::SegmentationStages& s = *stages_;
  const SegmentationOptions& options = s.options;
  if (s.on_grid) {
    segmentOnGrid(scan, s, labels);
    return;
  }
  s.image.project(scan, options.sensor, s.projection, threads);
  s.ground_detection.detect(s.image, s.sensor, options.ground, s.ground);
  s.component_filter.label(s.image, s.sensor, s.ground, options.components, s.pixel_labels, threads);
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
