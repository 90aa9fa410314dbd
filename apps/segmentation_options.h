#pragma once

#include <string>

#include "app_options.h"
#include "saw_ndt/segmentation/scan_segmenter.h"

namespace saw_ndt {

/// The options by which every app that segments scans is told how: they must be the same for a map and for the scans
/// localized in it.
class SegmentationArguments {
 public:
  /// Declares -sensor, -ground-rule and -mounting-pitch-deg.
  void addTo(AppOptions& app);
  /// What they say. @throws UsageError
  SegmentationOptions options() const;

 private:
  std::string sensor_ = SegmentationOptions().sensor.name;
  std::string ground_rule_ = "growing";
  double mounting_pitch_deg_ = SegmentationOptions().mounting_pitch_deg;
};

}  // namespace saw_ndt
