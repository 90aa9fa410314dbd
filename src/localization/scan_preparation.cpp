#include "saw_ndt/localization/scan_preparation.h"

#include <cmath>
#include <vector>

#include "common/executor.h"
#include "common/stopwatch.h"
#include "localization/source_voxel_filter.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {

using namespace internal;

void ScanPreparationOptions::check() const {
  segmentation.check();
  confidence.check();
  checkOption(ground_ratio >= 0.0 && ground_ratio <= 1.0, "ground_ratio", ground_ratio, "between 0 and 1");
  checkOption(source_voxel_size_m >= 0.0 && std::isfinite(source_voxel_size_m), "source_voxel_size_m",
              source_voxel_size_m, "0 or more");
  requireRigid(T_base_lidar, "T_base_lidar");
}

struct ScanPreparation::Parts {
  explicit Parts(const ScanPreparationOptions& with)
      : options(with), segmenter(with.segmentation), filter(with.source_voxel_size_m) {}

  ScanPreparationOptions options;
  ScanSegmenter segmenter;
  std::vector<StructuralLabel> labels;
  SourceVoxelFilter filter;
  double segment_ms = 0.0;
  double filter_ms = 0.0;
};

ScanPreparation::ScanPreparation(const ScanPreparationOptions& options)
    : parts_((options.check(), std::make_unique<Parts>(options))) {}
ScanPreparation::~ScanPreparation() = default;
ScanPreparation::ScanPreparation(ScanPreparation&& other) noexcept = default;
ScanPreparation& ScanPreparation::operator=(ScanPreparation&& other) noexcept = default;

const SourcePoints& ScanPreparation::prepare(const ScanView& scan) {
  Parts& parts = *parts_;
  const ScanPreparationOptions& options = parts.options;
  const internal::Stopwatch stopwatch;
  if (options.segment) parts.segmenter.segment(scan, parts.labels, internal::threadCount(options.threads));
  parts.segment_ms = options.segment ? stopwatch.milliseconds() : 0.0;

  const internal::Stopwatch filter_stopwatch;
  const SourcePoints& source = parts.filter.filter(scan, options.segment ? &parts.labels : nullptr,
                                                   {options.ground_ratio, options.confidence, options.T_base_lidar});
  parts.filter_ms = filter_stopwatch.milliseconds();
  return source;
}

double ScanPreparation::segmentMilliseconds() const { return parts_->segment_ms; }
double ScanPreparation::filterMilliseconds() const { return parts_->filter_ms; }

}  // namespace saw_ndt
