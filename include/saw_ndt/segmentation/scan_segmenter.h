#pragma once

#include <memory>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/labels.h"
#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/segmentation/segmentation_options.h"

namespace saw_ndt {

namespace internal {
struct SegmentationStages;
}

/// Range-image segmentation of a scan (section III.A of the paper): the label of every point. It allocates nothing once
/// it has seen a scan as large as the present one. Not to be shared by threads that call it at the same time.
class SAW_NDT_EXPORT ScanSegmenter {
 public:
  /// Throws std::invalid_argument where an option is out of its limits.
  explicit ScanSegmenter(const SegmentationOptions& options = SegmentationOptions());
  ~ScanSegmenter();
  ScanSegmenter(ScanSegmenter&& other) noexcept;
  ScanSegmenter& operator=(ScanSegmenter&& other) noexcept;

  const SegmentationOptions& options() const;

  /// Writes the label of every point in input order. Points that are not finite, at the sensor's origin or outside of
  /// its field of view are Noise; all points of a pixel have the same label.
  /// @param threads  0: all cores; labels do not depend on it
  void segment(const ScanView& scan, std::vector<StructuralLabel>& labels, int threads = 1);

  /// The stages and what they left of the last scan, for this project's own programs.
  const internal::SegmentationStages& stages() const { return *stages_; }

 private:
  std::unique_ptr<internal::SegmentationStages> stages_;
};

}  // namespace saw_ndt
