#pragma once

#include "saw_ndt/map/weighted_voxel_map.h"
#include "saw_ndt/registration/alignment.h"
#include "registration/vectorized_ndt_objective.h"

namespace saw_ndt {

/// Evaluations as an alignment makes them, one after the other: the source has been put in order.
class RepeatedEvaluation {
 public:
  /// @param map      is referred to, not copied
  /// @param options  threads: 1 or more
  RepeatedEvaluation(const WeightedVoxelMap& map, const SourcePoints& source, const AlignmentOptions& options)
      : objective_(map.fine(), options.neighborhood_search,
                   scoreParameters(options.score_function, options.outlier_ratio, map.resolution()),
                   {options.use_weights && map.labelled() && source.labelled, options.mismatch_penalty,
                    map.weighting().confidence}),
        threads_(options.threads) {
    source_.order(source, map.resolution(), map.weighting().confidence, threads_);
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
