#pragma once

#include <cstdint>

#include "saw_ndt/common/export.h"

namespace saw_ndt {

/// Options of ground subsampling.
struct SAW_NDT_EXPORT GroundSubsamplingOptions {
  /// Share of the ground points that is kept, 0 to 1; rho in section III.C of the paper.
  double ground_ratio = 0.5;

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// Which ground points of a scan are kept: ground point k, counted from 0 in scan order, where
/// floor((k + 1) rho) > floor(k rho). A ratio of 0.5 keeps every other one. It counts: not to be shared by threads.
class SAW_NDT_EXPORT GroundSampler {
 public:
  /// Throws std::invalid_argument where an option is out of its limits.
  explicit GroundSampler(const GroundSubsamplingOptions& options);

  /// Counts one more ground point and tells whether it is kept.
  bool keepsNext() { return keepsNext(true); }
  /// The same for one more point that may be no ground, which is not counted but kept. Without a branch.
  bool keepsNext(bool is_ground) {
    counted_ += static_cast<std::int64_t>(is_ground);
    const auto kept = static_cast<std::int64_t>(static_cast<double>(counted_) * ratio_);
    const bool keeps = !is_ground | (kept > kept_);
    kept_ = kept;
    return keeps;
  }

 private:
  double ratio_;
  std::int64_t counted_ = 0;
  std::int64_t kept_ = 0;
};

}  // namespace saw_ndt
