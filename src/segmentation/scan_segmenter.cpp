#include "saw_ndt/segmentation/scan_segmenter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/executor.h"
#include "saw_ndt/common/geometry.h"
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

// As far as a sensor leans by more than the ground may.
std::vector<float> lowestTangents(const SensorModel& sensor, const ScanProjection& projection) {
  constexpr double kUpright_deg = 5.0;
  if (std::abs(projection.R_level_lidar(2, 2)) > std::cos(radiansFromDegrees(kUpright_deg))) return {};
  std::vector<float> tangents;
  for (int column = 0; column < sensor.columns; ++column) {
    const double azimuth = 2.0 * kPi * (column + 0.5) / sensor.columns;
    double lowest = std::numeric_limits<double>::infinity();
    for (const double elevation_deg : {sensor.elevations_deg.front(), sensor.elevations_deg.back()}) {
      const double elevation = radiansFromDegrees(elevation_deg);
      const Eigen::Vector3d beam(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                 std::sin(elevation));
      const Eigen::Vector3d level = projection.R_level_lidar.cast<double>() * beam;
      lowest = std::min(lowest, level.z() / level.head<2>().norm());
    }
    tangents.push_back(static_cast<float>(lowest));
  }
  return tangents;
}

}  // namespace

internal::SegmentationStages::SegmentationStages(const SegmentationOptions& with)
    : options(with),
      projection(with),
      on_grid(with.sensor.rows() == 0 || projection.liesOnItsSide()),
      sensor(with.sensor) {
  if (!on_grid) lowest_tangents = lowestTangents(sensor, projection);
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
  s.ground_detection.detect(s.image, s.sensor, options.ground, s.ground, s.lowest_tangents);
  s.component_filter.label(s.image, s.sensor, s.ground, options.components, s.pixel_labels, threads);
  if (options.ground.rule == GroundRule::GROWING) s.ground_detection.takeBackDoubts(s.image, s.sensor, s.pixel_labels);
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
