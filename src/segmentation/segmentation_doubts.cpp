#include <algorithm>
#include <cmath>
#include <sstream>

#include "common/no_return.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/segmentation/scan_segmenter.h"
#include "saw_ndt/segmentation/sensor_setup.h"
#include "segmentation/segmentation_stages.h"

namespace saw_ndt {

using namespace internal;

namespace {

constexpr double kMostNoise = 0.5;
constexpr double kLeastGround = 0.05;
constexpr double kMostOffBeams = 0.1;
constexpr double kLeastHeight_m = 0.3;
constexpr double kGreatestHeight_m = 5.0;

std::string percentText(double share) {
  return std::to_string(static_cast<int>(std::lround(100.0 * share))) + " %";
}

std::string metresText(double metres) {
  std::ostringstream text;
  text.precision(2);
  text << std::fixed << metres << " m";
  return text.str();
}

/// Share of the returns whose elevation is farther from the beam of their row than half the way to the next.
double shareOffBeams(const ScanView& scan, const SensorModel& sensor, const RangeImage& image, bool upside_down) {
  std::size_t seen = 0, off = 0;
  for (std::size_t i = 0; i < scan.size; ++i) {
    const float* const p = scan.point(i);
    const float horizontal = std::hypot(p[0], p[1]);
    constexpr float kLeastRange_m = 2.0F;
    if (!isReturn(p) || !(horizontal > kLeastRange_m) || !std::isfinite(horizontal) || !std::isfinite(p[2])) continue;
    ++seen;
    const std::int32_t pixel = image.pixelOfPoint()[i];
    if (pixel == RangeImage::kNoPixel) {
      ++off;
      continue;
    }
    const int image_row = pixel / image.columns();
    const int row = upside_down ? image.rows() - 1 - image_row : image_row;
    const double beam_deg = sensor.elevations_deg[static_cast<std::size_t>(row)];
    double reach_deg = 1.0;
    if (row > 0) reach_deg = std::max(reach_deg, sensor.elevations_deg[static_cast<std::size_t>(row - 1)] - beam_deg);
    if (std::abs(degreesFromRadians(std::atan2(p[2], horizontal)) - beam_deg) > reach_deg) ++off;
  }
  return seen == 0 ? 0.0 : static_cast<double>(off) / static_cast<double>(seen);
}

}  // namespace

std::vector<std::string> segmentationDoubts(const ScanView& scan, const SegmentationOptions& options) {
  std::vector<std::string> doubts;
  ScanSegmenter segmenter(options);
  std::vector<StructuralLabel> labels;
  segmenter.segment(scan, labels);
  const SegmentationStages& stages = segmenter.stages();
  double returns = 0.0, noise = 0.0, ground = 0.0, below = 0.0;
  for (std::size_t i = 0; i < scan.size; ++i) {
    const float* const p = scan.point(i);
    if (!isReturn(p) || !std::isfinite(p[0] + p[1] + p[2])) continue;
    returns += 1.0;
    noise += labels[i] == StructuralLabel::NOISE ? 1.0 : 0.0;
    ground += labels[i] == StructuralLabel::GROUND ? 1.0 : 0.0;
    below += stages.projection.R_level_lidar.row(2).dot(Eigen::Map<const Eigen::RowVector3f>(p)) < -0.3F ? 1.0 : 0.0;
  }
  if (returns == 0.0) {
    doubts.emplace_back("the scan has no return");
    return doubts;
  }
  if (!stages.on_grid) {
    const double off = shareOffBeams(scan, options.sensor, stages.image, stages.projection.isUpsideDown());
    if (off > kMostOffBeams) {
      doubts.push_back(percentText(off) + " of the points lie off the beams of the sensor model " +
                       options.sensor.name + ": it may be another sensor, or the points in another frame");
    }
  }
  if (noise > kMostNoise * returns) doubts.push_back(percentText(noise / returns) + " of the points are noise");
  if (ground < kLeastGround * returns && below > kLeastGround * returns) {
    doubts.push_back(percentText(ground / returns) + " of the points are ground, where " + percentText(below / returns) +
                     " lie below the sensor: it may be mounted in another way");
  }
  const double height_m = stages.ground_detection.sensorHeight();
  if (options.ground.rule == GroundRule::GROWING && ground > 0.0 &&
      (height_m < kLeastHeight_m || height_m > kGreatestHeight_m)) {
    doubts.push_back("the ground lies " + metresText(height_m) +
                     " below the origin of the points, which is unlikely: they may be in the frame of the vehicle");
  }
  if (const auto mounting = learnMounting(scan)) {
    SegmentationOptions seen = options;
    seen.mounting_pitch_deg = mounting->pitch_deg;
    seen.mounting_roll_deg = mounting->roll_deg;
    const float cosine =
        ScanProjection(seen).R_level_lidar.row(2).dot(stages.projection.R_level_lidar.row(2));
    constexpr float kSameLean = 0.966F;  // 15 degrees
    if (cosine < kSameLean) {
      std::ostringstream text;
      text.precision(0);
      text << std::fixed << "the ground leans as if the sensor were rolled by " << mounting->roll_deg
           << " degrees and pitched by " << mounting->pitch_deg;
      doubts.push_back(text.str());
    }
  }
  return doubts;
}

}  // namespace saw_ndt
