#include <algorithm>

#include "saw_ndt/segmentation/scan_segmenter.h"
#include "saw_ndt/segmentation/sensor_setup.h"

namespace saw_ndt {

namespace {

constexpr double kStep_deg = 3.0;
constexpr int kMostSteps = 3;
// Of the ground that there is without: on KITTI three degrees more gain less than 0.03.
constexpr double kLeastGain = 0.05;
constexpr double kNoGain = 0.02;

double groundPoints(const ScanView& scan, SegmentationOptions options, double slope_deg) {
  options.ground.slope_deg = slope_deg;
  std::vector<StructuralLabel> labels;
  ScanSegmenter(options).segment(scan, labels);
  return static_cast<double>(std::count(labels.begin(), labels.end(), StructuralLabel::GROUND));
}

/// How much steeper the ground is than the options say (degrees); 0: it is not.
double steeperBy(const ScanView& scan, const SegmentationOptions& options) {
  const double points = groundPoints(scan, options, options.ground.slope_deg);
  double before = points;
  for (int step = 1; step <= kMostSteps; ++step) {
    const double now = groundPoints(scan, options, options.ground.slope_deg + step * kStep_deg);
    const bool is_all = now - before <= kNoGain * points;
    if (is_all) return before - points > kLeastGain * points ? (step - 1) * kStep_deg : 0.0;
    before = now;
  }
  return 0.0;
}

}  // namespace

SegmentationOptions withSlope(const SegmentationOptions& options, const std::vector<ScanView>& scans) {
  SegmentationOptions result = options;
  for (const ScanView& scan : scans) {
    result.ground.slope_deg = std::max(result.ground.slope_deg, options.ground.slope_deg + steeperBy(scan, options));
  }
  return result;
}

}  // namespace saw_ndt
