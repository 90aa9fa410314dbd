#pragma once

#include <memory>

#include "saw_ndt/common/export.h"
#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/registration/alignment.h"
#include "saw_ndt/registration/source_points.h"

namespace saw_ndt {

/// Registers source points to a target. Holds nothing but scratch memory that calls reuse, which copies do not share:
/// not to be used by several threads at the same time. The target may be shared.
class SAW_NDT_EXPORT NdtAligner {
 public:
  NdtAligner();
  ~NdtAligner();
  NdtAligner(const NdtAligner& other);
  NdtAligner& operator=(const NdtAligner& other);

  /// @param guess  T_map_source to start from
  /// @throws std::invalid_argument for options that do not hold, a guess that is not finite, and a source of which a
  /// point is not within reach or has no label
  AlignmentResult align(const NdtTarget& target, const SourcePoints& source, const Eigen::Isometry3d& guess,
                        const AlignmentOptions& options);

 private:
  struct Scratch;

  std::unique_ptr<Scratch> scratch_;
};

}  // namespace saw_ndt
