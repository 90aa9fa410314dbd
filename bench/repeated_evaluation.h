#pragma once

#include "map/ndt_level.h"
#include "registration/vectorized_ndt_objective.h"
#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/registration/alignment.h"

namespace saw_ndt {

/// Evaluations as an alignment makes them, one after the other: the source has been put in order.
class RepeatedEvaluation {
 public:
  /// @param target   is referred to, not copied
  /// @param options  threads: 1 or more
  RepeatedEvaluation(const NdtTarget& target, const SourcePoints& source, const AlignmentOptions& options)
      : objective_(target.fine(), options.neighborhood_search,
                   scoreParameters(options.score_function, options.outlier_ratio, target.resolution()),
                   {options.use_weights && target.labelled() && source.labelled, options.mismatch_penalty,
                    target.weighting().confidence}),
        threads_(options.threads) {
    source_.order(source, target.resolution(), target.weighting().confidence, threads_);
  }

  NdtDerivatives at(const Eigen::Isometry3d& T_map_source) {
    return objective_.evaluate(source_, T_map_source, threads_, workspace_);
  }

 private:
  VectorizedNdtObjective objective_;
  int threads_;
  OrderedSource source_;
  BatchWorkspace workspace_;
};

}  // namespace saw_ndt
