#include "saw_ndt/localization/scan_preparation.h"

#include <cmath>
#include <optional>
#include <vector>

#include "common/executor.h"
#include "common/stopwatch.h"
#include "localization/motion_compensation.h"
#include "localization/source_voxel_filter.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {

using namespace internal;

const char* toString(MotionCompensation compensation) {
  switch (compensation) {
    case MotionCompensation::OFF:
      return "off";
    case MotionCompensation::FROM_TIMES:
      return "times";
    case MotionCompensation::FROM_AZIMUTH_COUNTERCLOCKWISE:
      return "counterclockwise";
    case MotionCompensation::FROM_AZIMUTH_CLOCKWISE:
      return "clockwise";
  }
  return "unknown";
}

void ScanPreparationOptions::check() const {
  segmentation.check();
  confidence.check();
  checkOption(ground_ratio >= 0.0 && ground_ratio <= 1.0, "ground_ratio", ground_ratio, "between 0 and 1");
  checkOption(source_voxel_size_m >= 0.0 && std::isfinite(source_voxel_size_m), "source_voxel_size_m",
              source_voxel_size_m, "0 or more");
  requireRigid(T_base_lidar, "T_base_lidar");
  checkOption(max_reach_m > 0.0, "max_reach_m", max_reach_m, "positive");
}

namespace {

// Keeps the points of a source within a horizontal distance of its origin, and their times where there are any.
void keepNear(const SourcePoints& source, const std::vector<float>& times_s, double reach_m, SourcePoints& near,
              std::vector<float>& near_times_s) {
  near.clear();
  near.labelled = source.labelled;
  near_times_s.clear();
  for (std::size_t i = 0; i < source.size(); ++i) {
    if (std::hypot(source.x[i], source.y[i]) > reach_m) continue;
    near.add(source.x[i], source.y[i], source.z[i], static_cast<StructuralLabel>(source.label[i]));
    if (!times_s.empty()) near_times_s.push_back(times_s[i]);
  }
}

}  // namespace

struct ScanPreparation::Parts {
  explicit Parts(const ScanPreparationOptions& with)
      : options(with), segmenter(with.segmentation), filter(with.source_voxel_size_m) {}

  ScanPreparationOptions options;
  ScanSegmenter segmenter;
  std::vector<StructuralLabel> labels;
  SourceVoxelFilter filter;
  SourcePoints near;           // of the last source, where max_reach_m is finite
  std::vector<float> times_s;  // unless they are the filter's
  double segment_ms = 0.0;
  double filter_ms = 0.0;
};

ScanPreparation::ScanPreparation(const ScanPreparationOptions& options)
    : parts_((options.check(), std::make_unique<Parts>(options))) {}
ScanPreparation::~ScanPreparation() = default;
ScanPreparation::ScanPreparation(ScanPreparation&& other) noexcept = default;
ScanPreparation& ScanPreparation::operator=(ScanPreparation&& other) noexcept = default;

const SourcePoints& ScanPreparation::prepare(const ScanView& scan, const ScanTiming& timing) {
  Parts& parts = *parts_;
  const ScanPreparationOptions& options = parts.options;
  const internal::Stopwatch stopwatch;
  if (options.segment) parts.segmenter.segment(scan, parts.labels, internal::threadCount(options.threads));
  parts.segment_ms = options.segment ? stopwatch.milliseconds() : 0.0;

  const internal::Stopwatch filter_stopwatch;
  std::optional<ScanClock> clock;
  if (options.motion_compensation == MotionCompensation::FROM_TIMES) clock = clockOf(scan, timing.stamp_s);
  const SourcePoints& whole =
      parts.filter.filter(scan, options.segment ? &parts.labels : nullptr,
                          {options.ground_ratio, options.confidence, options.T_base_lidar, clock ? &*clock : nullptr});
  const bool is_cut = std::isfinite(options.max_reach_m);
  if (is_cut) keepNear(whole, parts.filter.times_s(), options.max_reach_m, parts.near, parts.times_s);
  const SourcePoints& source = is_cut ? parts.near : whole;
  if (options.motion_compensation == MotionCompensation::FROM_AZIMUTH_COUNTERCLOCKWISE ||
      options.motion_compensation == MotionCompensation::FROM_AZIMUTH_CLOCKWISE) {
    timesFromAzimuth(source, options.T_base_lidar,
                     options.motion_compensation == MotionCompensation::FROM_AZIMUTH_COUNTERCLOCKWISE, timing.period_s,
                     parts.times_s);
  }
  parts.filter_ms = filter_stopwatch.milliseconds();
  return source;
}

const std::vector<float>& ScanPreparation::times_s() const {
  const bool by_filter = parts_->options.motion_compensation == MotionCompensation::FROM_TIMES &&
                         !std::isfinite(parts_->options.max_reach_m);
  return by_filter ? parts_->filter.times_s() : parts_->times_s;
}
double ScanPreparation::segmentMilliseconds() const { return parts_->segment_ms; }
double ScanPreparation::filterMilliseconds() const { return parts_->filter_ms; }

}  // namespace saw_ndt
