#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "registration/batch_workspace.h"
#include "registration/levelled_source.h"
#include "registration/ndt_derivatives.h"
#include "registration/ndt_objective.h"
#include "registration/vectorized_ndt_objective.h"
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

  /// Score and derivatives on the coarse level over every `coarse_stride`-th source point.
  Evaluation onCoarseLevel();
  /// The same over all on the levels that match, or those of them from `first_level` on. Where there are several, a
  /// point keeps to the one that it has at a pose near which it is evaluated. It ends what the one before it returned.
  Evaluation onMatchingLevels(const Eigen::Isometry3d& T_map_source_near, std::size_t first_level = 0);
  /// Likelihoods on the levels of the last onMatchingLevels().
  Likelihoods likelihoods(const Eigen::Isometry3d& T_map_source);

 private:
  template <typename Objective>
  Objective objectiveOn(const internal::NdtLevel& level, bool ground) const;
  bool inParts() const;
  Evaluation onLevel(const internal::NdtLevel& level, OrderedSource& points);
  Evaluation exactly(const internal::NdtLevel& level, std::size_t stride);
  Evaluation exactlyInParts(const Eigen::Isometry3d& T_map_source_near, std::size_t first_level);

  const NdtTarget* target_ = nullptr;
  const SourcePoints* source_ = nullptr;
  const AlignmentOptions* options_ = nullptr;
  OrderedSource ordered_;
  OrderedSource thinned_;
  LevelledSource levelled_;
  std::vector<VectorizedNdtObjective> objectives_;  // of the parts of levelled_
  PartsOfSource parts_;
  BatchWorkspace batches_;
  std::vector<SourcePoints> exact_parts_;
  NdtObjective::Workspace workspace_;
};

}  // namespace saw_ndt::internal
