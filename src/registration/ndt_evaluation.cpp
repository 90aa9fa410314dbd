#include "registration/ndt_evaluation.h"

#include "common/executor.h"
#include "map/ndt_level.h"
#include "registration/likelihoods.h"
#include "registration/score_function.h"
#include "registration/vectorized_ndt_objective.h"

namespace saw_ndt::internal {

template <typename Objective>
Objective NdtEvaluation::objectiveOn(const internal::NdtLevel& level, bool ground) const {
  const PairWeighting weighting{options_->use_weights && target_->labelled() && source_->labelled,
                                options_->mismatch_penalty, target_->weighting().confidence};
  const bool own_column = ground && options_->ground_in_own_column;
  return {level, own_column ? NeighborhoodSearchMethod::DIRECT3 : options_->neighborhood_search,
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

bool NdtEvaluation::inParts() const { return target_->levels().size() > 1 || options_->ground_in_own_column; }

Evaluation NdtEvaluation::exactly(const internal::NdtLevel& level, std::size_t stride) {
  return [this, objective = objectiveOn<NdtObjective>(level, false), stride](const Eigen::Isometry3d& T) {
    return objective.evaluate(*source_, T, internal::threadCount(options_->threads), workspace_, stride);
  };
}

// As LevelledSource, in double precision.
Evaluation NdtEvaluation::exactlyInParts(const Eigen::Isometry3d& T_map_source_near, std::size_t first_level) {
  const std::vector<NdtLevel>& levels = target_->levels();
  exact_parts_.assign(2 * levels.size(), {});
  std::vector<NdtObjective> objectives;
  for (std::size_t part = 0; part < exact_parts_.size(); ++part) {
    exact_parts_[part].labelled = source_->labelled;
    objectives.push_back(objectiveOn<NdtObjective>(levels[part % levels.size()], part >= levels.size()));
  }
  for (std::size_t i = 0; i < source_->size(); ++i) {
    const Eigen::Vector3f point(source_->x[i], source_->y[i], source_->z[i]);
    const Eigen::Vector3d in_map = T_map_source_near * point.cast<double>();
    std::size_t level = first_level;
    while (level + 1 < levels.size() && levels[level].find(in_map) == VoxelIndex::kNone) ++level;
    const auto label = static_cast<StructuralLabel>(source_->label[i]);
    const std::size_t part = label == StructuralLabel::GROUND ? levels.size() + level : level;
    exact_parts_[part].add(point.x(), point.y(), point.z(), label);
  }
  return [this, objectives](const Eigen::Isometry3d& T) {
    NdtDerivatives sum;
    for (std::size_t i = 0; i < objectives.size(); ++i) {
      sum += objectives[i].evaluate(exact_parts_[i], T, internal::threadCount(options_->threads), workspace_);
    }
    return sum;
  };
}

Evaluation NdtEvaluation::onLevel(const internal::NdtLevel& level, OrderedSource& points) {
  return [this, objective = objectiveOn<VectorizedNdtObjective>(level, false), &points](const Eigen::Isometry3d& T) {
    return objective.evaluate(points, T, internal::threadCount(options_->threads), batches_);
  };
}

Evaluation NdtEvaluation::onCoarseLevel() {
  const auto stride = static_cast<std::size_t>(options_->coarse_stride);
  if (options_->arithmetic == Arithmetic::DOUBLE) return exactly(target_->coarse(), stride);
  if (stride == 1) return onLevel(target_->coarse(), ordered_);
  thinned_.thin(ordered_, stride);
  return onLevel(target_->coarse(), thinned_);
}

Evaluation NdtEvaluation::onMatchingLevels(const Eigen::Isometry3d& T_map_source_near, std::size_t first_level) {
  const bool in_doubles = options_->arithmetic == Arithmetic::DOUBLE;
  if (!inParts()) return in_doubles ? exactly(target_->fine(), 1) : onLevel(target_->fine(), ordered_);
  const int threads = internal::threadCount(options_->threads);
  if (!in_doubles || options_->evaluate_likelihoods) {
    levelled_.assign(*target_, ordered_, T_map_source_near, first_level, options_->ground_in_own_column, threads,
                     batches_);
  }
  if (in_doubles) return exactlyInParts(T_map_source_near, first_level);
  objectives_.clear();
  parts_.clear();
  for (std::size_t part = 0; part < levelled_.parts().size(); ++part) {
    const NdtLevel& level = target_->levels()[levelled_.levelOf(part)];
    objectives_.push_back(objectiveOn<VectorizedNdtObjective>(level, levelled_.isGround(part)));
  }
  for (std::size_t part = 0; part < objectives_.size(); ++part) {
    parts_.push_back({&objectives_[part], &levelled_.parts()[part]});
  }
  return [this, threads](const Eigen::Isometry3d& T) { return evaluateAll(parts_, T, threads, batches_); };
}

Likelihoods NdtEvaluation::likelihoods(const Eigen::Isometry3d& T_map_source) {
  const int threads = internal::threadCount(options_->threads);
  const double outlier_ratio = AlignmentOptions().outlier_ratio;
  if (inParts()) return evaluateLikelihoods(*target_, levelled_, T_map_source, outlier_ratio, threads, batches_);
  return evaluateLikelihoods(target_->fine(), ordered_, T_map_source, outlier_ratio, threads, batches_);
}

}  // namespace saw_ndt::internal
