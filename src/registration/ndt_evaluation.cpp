#include "registration/ndt_evaluation.h"

#include "common/executor.h"
#include "map/ndt_level.h"
#include "registration/likelihoods.h"
#include "registration/score_function.h"
#include "registration/vectorized_ndt_objective.h"

namespace saw_ndt::internal {

template <typename Objective>
Objective NdtEvaluation::objectiveOn(const internal::NdtLevel& level) const {
  const PairWeighting weighting{options_->use_weights && target_->labelled() && source_->labelled,
                                options_->mismatch_penalty, target_->weighting().confidence};
  return {level, options_->neighborhood_search,
          scoreParameters(options_->score_function, options_->outlier_ratio, level.resolution()), weighting};
}

void NdtEvaluation::begin(const NdtTarget& target, const SourcePoints& source, const AlignmentOptions& options) {
  target_ = &target;
  source_ = &source;
  options_ = &options;
  if (options.arithmetic == Arithmetic::SINGLE || options.evaluate_likelihoods) {
    ordered_.order(source, target.resolution(), target.weighting().confidence, internal::threadCount(options.threads));
  }
}

Evaluation NdtEvaluation::onFineLevel() { return on(target_->fine(), 1); }

Evaluation NdtEvaluation::onCoarseLevel() {
  return on(target_->coarse(), static_cast<std::size_t>(options_->coarse_stride));
}

Evaluation NdtEvaluation::on(const internal::NdtLevel& level, std::size_t stride) {
  const int threads = internal::threadCount(options_->threads);
  if (options_->arithmetic == Arithmetic::DOUBLE) {
    return [this, objective = objectiveOn<NdtObjective>(level), threads, stride](const Eigen::Isometry3d& T) {
      return objective.evaluate(*source_, T, threads, workspace_, stride);
    };
  }
  OrderedSource* points = &ordered_;
  if (stride > 1) {
    thinned_.thin(ordered_, stride);
    points = &thinned_;
  }
  return [this, objective = objectiveOn<VectorizedNdtObjective>(level), points, threads](const Eigen::Isometry3d& T) {
    return objective.evaluate(*points, T, threads, batches_);
  };
}

Likelihoods NdtEvaluation::likelihoods(const Eigen::Isometry3d& T_map_source) {
  return evaluateLikelihoods(target_->fine(), ordered_, T_map_source, AlignmentOptions().outlier_ratio,
                             internal::threadCount(options_->threads), batches_);
}

}  // namespace saw_ndt::internal
