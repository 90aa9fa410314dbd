#include "saw_ndt/registration/ndt_aligner.h"

#include <algorithm>
#include <stdexcept>

#include "optimizers.h"
#include "saw_ndt/common/threads.h"

namespace saw_ndt {
namespace {

NdtObjective objectiveOn(const NdtLevel& level, const WeightedVoxelMap& map, const SourcePoints& source,
                         const AlignmentOptions& options) {
  PairWeighting weighting;
  weighting.enabled = options.use_weights && map.labelled() && source.labelled;
  weighting.mismatch_penalty = options.mismatch_penalty;
  weighting.confidence = map.weighting().confidence;
  return {level, options.neighborhood_search,
          scoreParameters(options.score_function, options.outlier_ratio, level.resolution()), weighting};
}

}  // namespace

AlignmentResult NdtAligner::align(const WeightedVoxelMap& map, const SourcePoints& source,
                                  const Eigen::Isometry3d& guess, const AlignmentOptions& options) {
  options.check();
  if (!guess.matrix().allFinite()) throw std::invalid_argument("the initial guess is not finite");
  AlignmentResult result;
  result.T_map_source = guess;
  result.status = map.empty() ? AlignmentStatus::NO_TARGET : AlignmentStatus::NO_SOURCE;
  if (map.empty() || source.empty()) return result;

  const int threads = threadCount(options.threads);
  const double resolution = map.resolution();
  StepLimits limits{options.max_iterations, options.translation_epsilon_m, options.rotation_epsilon_rad,
                    options.max_step_m * resolution};

  if (options.optimizer == Optimizer::DAMPED_NEWTON && options.use_coarse_level && !map.coarse().empty()) {
    const NdtObjective coarse = objectiveOn(map.coarse(), map, source, options);
    const Evaluation evaluate = [&](const Eigen::Isometry3d& T) {
      return coarse.evaluate(source, T, threads, workspace_, static_cast<std::size_t>(options.coarse_stride));
    };
    StepLimits coarse_limits = limits;
    coarse_limits.max_iterations = options.coarse_max_iterations;
    coarse_limits.translation_epsilon_m = options.coarse_settled_voxels * resolution;
    coarse_limits.rotation_epsilon_rad = 1.0;
    coarse_limits.max_step_m = options.max_step_m * map.coarse().resolution();
    dampedNewton(evaluate, coarse_limits, options.least_curvature_share, result);
    // A first step that is already small says that the guess is good; the coarse optimum is no better than it.
    if (result.evaluations == 1) result.T_map_source = guess;
    result.iterations = 0;
  }

  const NdtObjective fine = objectiveOn(map.fine(), map, source, options);
  const Evaluation evaluate = [&](const Eigen::Isometry3d& T) { return fine.evaluate(source, T, threads, workspace_); };
  if (options.optimizer == Optimizer::DAMPED_NEWTON) {
    dampedNewton(evaluate, limits, options.least_curvature_share, result);
  } else {
    newtonMoreThuente(evaluate, limits, options.line_search_min_step, options.line_search_max_step, result);
  }
  result.likelihood = result.score / static_cast<double>(source.size());
  return result;
}

NdtDerivatives NdtAligner::evaluate(const WeightedVoxelMap& map, const SourcePoints& source,
                                    const Eigen::Isometry3d& T_map_source, const AlignmentOptions& options) {
  options.check();
  return objectiveOn(map.fine(), map, source, options)
      .evaluate(source, T_map_source, threadCount(options.threads), workspace_);
}

}  // namespace saw_ndt
