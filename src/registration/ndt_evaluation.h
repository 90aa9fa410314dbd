#pragma once

#include <functional>

#include "registration/batch_workspace.h"
#include "registration/ndt_derivatives.h"
#include "registration/ndt_objective.h"
#include "registration/ordered_source.h"
#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/registration/alignment.h"
#include "saw_ndt/registration/source_points.h"

namespace saw_ndt::internal {

/// Score and derivatives at a pose.
using Evaluation = std::function<NdtDerivatives(const Eigen::Isometry3d& T_map_source)>;

/// Evaluates a source against a target by the arithmetic that options ask for. Keeps scratch memory between calls.
class NdtEvaluation {
 public:
  /// Takes over what following calls evaluate; all of it must outlive them.
  void begin(const NdtTarget& target, const SourcePoints& source, const AlignmentOptions& options);

  /// Score and derivatives on the fine level, and on the coarse one over every `coarse_stride`-th source point.
  Evaluation onFineLevel();
  Evaluation onCoarseLevel();
  /// Likelihoods on the fine level.
  Likelihoods likelihoods(const Eigen::Isometry3d& T_map_source);

 private:
  Evaluation on(const internal::NdtLevel& level, std::size_t stride);
  template <typename Objective>
  Objective objectiveOn(const internal::NdtLevel& level) const;

  const NdtTarget* target_ = nullptr;
  const SourcePoints* source_ = nullptr;
  const AlignmentOptions* options_ = nullptr;
  OrderedSource ordered_;
  OrderedSource thinned_;
  BatchWorkspace batches_;
  NdtObjective::Workspace workspace_;
};

}  // namespace saw_ndt::internal
