#pragma once

#include <functional>

#include "registration/batch_workspace.h"
#include "registration/ordered_source.h"
#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/registration/alignment.h"

namespace saw_ndt {

/// Registers source points to a target. Holds nothing but scratch memory that calls reuse: not to be shared by threads
/// that call it at the same time.
class NdtAligner {
 public:
  /// @param guess  T_map_source to start from
  /// @throws std::invalid_argument for options that do not hold, a guess that is not finite, or Arithmetic::DOUBLE
  /// with a target that has no cells in double precision
  AlignmentResult align(const NdtTarget& target, const SourcePoints& source, const Eigen::Isometry3d& guess,
                        const AlignmentOptions& options);

  /// Score and derivatives on the fine level at one pose.
  NdtDerivatives evaluate(const NdtTarget& target, const SourcePoints& source, const Eigen::Isometry3d& T_map_source,
                          const AlignmentOptions& options);

 private:
  /// Score and derivatives of every `stride`-th source point on a level; refers to all that it is given.
  std::function<NdtDerivatives(const Eigen::Isometry3d&)> evaluationOn(const internal::NdtLevel& level,
                                                                       const NdtTarget& target,
                                                                       const SourcePoints& source, std::size_t stride,
                                                                       const AlignmentOptions& options);

  OrderedSource ordered_;
  OrderedSource thinned_;
  BatchWorkspace batches_;
  NdtObjective::Workspace workspace_;
};

}  // namespace saw_ndt
