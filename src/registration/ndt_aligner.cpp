#include "saw_ndt/registration/ndt_aligner.h"

#include <algorithm>
#include <stdexcept>

#include "common/threads.h"
#include "map/ndt_level.h"
#include "registration/optimizers.h"
#include "registration/vectorized_ndt_objective.h"

namespace saw_ndt {
namespace {

PairWeighting pairWeighting(const NdtTarget& target, const SourcePoints& source, const AlignmentOptions& options) {
  return {options.use_weights && target.labelled() && source.labelled, options.mismatch_penalty,
          target.weighting().confidence};
}

template <typename Objective>
Objective objectiveOn(const internal::NdtLevel& level, const NdtTarget& target, const SourcePoints& source,
                      const AlignmentOptions& options) {
  return {level, options.neighborhood_search,
          scoreParameters(options.score_function, options.outlier_ratio, level.resolution()),
          pairWeighting(target, source, options)};
}

}  // namespace

Evaluation NdtAligner::evaluationOn(const internal::NdtLevel& level, const NdtTarget& target,
                                    const SourcePoints& source, std::size_t stride, const AlignmentOptions& options) {
  const int threads = threadCount(options.threads);
  if (options.arithmetic == Arithmetic::DOUBLE) {
    const auto objective = objectiveOn<NdtObjective>(level, target, source, options);
    return [this, objective, &source, threads, stride](const Eigen::Isometry3d& T) {
      return objective.evaluate(source, T, threads, workspace_, stride);
    };
  }
  OrderedSource* points = &ordered_;
  if (stride > 1) {
    thinned_.thin(ordered_, stride);
    points = &thinned_;
  }
  const auto objective = objectiveOn<VectorizedNdtObjective>(level, target, source, options);
  return [this, objective, points, threads](const Eigen::Isometry3d& T) {
    return objective.evaluate(*points, T, threads, batches_);
  };
}

AlignmentResult NdtAligner::align(const NdtTarget& target, const SourcePoints& source, const Eigen::Isometry3d& guess,
                                  const AlignmentOptions& options) {
  options.check();
  if (!guess.matrix().allFinite()) throw std::invalid_argument("the initial guess is not finite");
  AlignmentResult result;
  result.T_map_source = guess;
  result.status = target.empty() ? AlignmentStatus::NO_TARGET : AlignmentStatus::NO_SOURCE;
  if (target.empty() || source.empty()) return result;

  const double resolution = target.resolution();
  StepLimits limits{options.max_iterations, options.translation_epsilon_m, options.rotation_epsilon_rad,
                    options.max_step_m * resolution};
  if (options.arithmetic == Arithmetic::SINGLE || options.evaluate_likelihoods) {
    ordered_.order(source, resolution, target.weighting().confidence, threadCount(options.threads));
  }

  if (options.optimizer == Optimizer::DAMPED_NEWTON && options.use_coarse_level && !target.coarse().empty()) {
    const Evaluation evaluate =
        evaluationOn(target.coarse(), target, source, static_cast<std::size_t>(options.coarse_stride), options);
    StepLimits coarse_limits = limits;
    coarse_limits.max_iterations = options.coarse_max_iterations;
    coarse_limits.translation_epsilon_m = options.coarse_settled_voxels * resolution;
    coarse_limits.rotation_epsilon_rad = 1.0;
    coarse_limits.max_step_m = options.max_step_m * target.coarse().resolution();
    dampedNewton(evaluate, coarse_limits, options.least_curvature_share, result);
    // A first step that is already small says that the guess is good; the coarse optimum is no better than it.
    if (result.evaluations == 1) result.T_map_source = guess;
    result.iterations = 0;
  }

  const Evaluation evaluate = evaluationOn(target.fine(), target, source, 1, options);
  if (options.optimizer == Optimizer::DAMPED_NEWTON) {
    dampedNewton(evaluate, limits, options.least_curvature_share, result);
  } else {
    newtonMoreThuente(evaluate, limits, options.line_search_min_step, options.line_search_max_step, result);
  }
  result.likelihood = result.score / static_cast<double>(source.size());
  if (options.evaluate_likelihoods) {
    result.likelihoods = evaluateLikelihoods(target.fine(), ordered_, result.T_map_source,
                                             AlignmentOptions().outlier_ratio, threadCount(options.threads), batches_);
  }
  return result;
}

NdtDerivatives NdtAligner::evaluate(const NdtTarget& target, const SourcePoints& source,
                                    const Eigen::Isometry3d& T_map_source, const AlignmentOptions& options) {
  options.check();
  if (options.arithmetic == Arithmetic::SINGLE) {
    ordered_.order(source, target.resolution(), target.weighting().confidence, threadCount(options.threads));
  }
  return evaluationOn(target.fine(), target, source, 1, options)(T_map_source);
}

}  // namespace saw_ndt
