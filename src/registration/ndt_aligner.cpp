#include "saw_ndt/registration/ndt_aligner.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "common/executor.h"
#include "common/middle_value.h"
#include "map/ndt_level.h"
#include "registration/alignment_assessment.h"
#include "registration/ndt_evaluation.h"
#include "registration/optimizers.h"
#include "registration/source_check.h"

namespace saw_ndt {

using namespace internal;

namespace {

StepLimits limitsOf(const NdtTarget& target, const AlignmentOptions& options) {
  return {options.max_iterations, options.translation_epsilon_m, options.rotation_epsilon_rad,
          options.max_step_m * target.resolution()};
}

// To within a fraction of a smallest voxel, where the guess is not as good as that.
void alignCoarsely(const NdtTarget& target, const AlignmentOptions& options, NdtEvaluation& evaluation,
                   AlignmentResult& result) {
  const Eigen::Isometry3d guess = result.T_map_source;
  StepLimits limits = limitsOf(target, options);
  limits.max_iterations = options.coarse_max_iterations;
  limits.translation_epsilon_m = options.coarse_settled_voxels * target.resolution();
  limits.rotation_epsilon_rad = 1.0;
  limits.max_step_m = options.max_step_m * target.coarse().resolution();
  dampedNewton(evaluation.onCoarseLevel(), limits, options.min_curvature_share, result);
  if (result.evaluations == 1) {
    // A first step that is already small says that the guess is good; the coarse optimum is no better than it.
    result.T_map_source = guess;
  } else if (target.levels().size() > 1) {
    // From there the optimum may be farther than the smallest voxels reach.
    limits.max_step_m = options.max_step_m * target.levels()[1].resolution();
    dampedNewton(evaluation.onMatchingLevels(result.T_map_source, 1), limits, options.min_curvature_share, result);
  }
  result.iterations = 0;
}

// Points keep to the level that they have where the optimum is sought from, and draw it there a little: it is sought
// again from where it was found, while that is far.
void alignOnSeveralLevels(const NdtTarget& target, const AlignmentOptions& options, NdtEvaluation& evaluation,
                          AlignmentResult& result) {
  constexpr int kMostRounds = 8;
  constexpr double kNearVoxels = 0.04;
  StepLimits limits = limitsOf(target, options);
  for (int round = 0; round < kMostRounds && result.iterations < options.max_iterations; ++round) {
    limits.max_iterations = options.max_iterations - result.iterations;
    const Eigen::Vector3d from = result.T_map_source.translation();
    dampedNewton(evaluation.onMatchingLevels(result.T_map_source), limits, options.min_curvature_share, result);
    if ((result.T_map_source.translation() - from).norm() < kNearVoxels * target.resolution()) break;
  }
}

// A source whose middle is farther than this from its origin is moved: single precision would lose what is small beside
// that distance, and a step of the rotation would throw the points far off (m).
constexpr double kFarMiddle_m = 100.0;

// Along each axis the median of a sample of the points.
Eigen::Vector3d medianOf(const SourcePoints& source) {
  constexpr std::size_t kSampledPoints = 1000;
  const std::size_t stride = (source.size() + kSampledPoints - 1) / kSampledPoints;
  std::vector<float> sample;
  const auto median = [&](const std::vector<float>& values) {
    sample.clear();
    for (std::size_t i = 0; i < values.size(); i += stride) sample.push_back(values[i]);
    return static_cast<double>(middleValue(sample));
  };
  return {median(source.x), median(source.y), median(source.z)};
}

// The middle of the points, to be taken as their origin, or the origin that they have.
Eigen::Vector3d rotationCentre(const SourcePoints& source) {
  const auto ifFar = [](const Eigen::Vector3d& middle) {
    return middle.norm() > kFarMiddle_m ? middle : Eigen::Vector3d(Eigen::Vector3d::Zero());
  };
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < source.size(); ++i) sum += Eigen::Vector3d(source.x[i], source.y[i], source.z[i]);
  const Eigen::Vector3d mean = sum / static_cast<double>(source.size());
  if (mean.norm() <= kFarMiddle_m) return Eigen::Vector3d::Zero();
  // A few points that are far from all others must not lead away from these.
  const Eigen::Vector3d median = medianOf(source);
  return (mean - median).norm() <= kFarMiddle_m ? mean : ifFar(median);
}

void moveTo(const Eigen::Vector3d& origin, const SourcePoints& source, SourcePoints& moved) {
  moved.label = source.label;
  moved.labelled = source.labelled;
  const auto move = [](const std::vector<float>& from, double by, std::vector<float>& to) {
    to.resize(from.size());
    std::transform(from.begin(), from.end(), to.begin(), [by](float value) { return static_cast<float>(value - by); });
  };
  move(source.x, origin.x(), moved.x);
  move(source.y, origin.y(), moved.y);
  move(source.z, origin.z(), moved.z);
}

// Of points that lie around their origin.
void alignNear(const NdtTarget& target, const SourcePoints& source, const AlignmentOptions& options,
               NdtEvaluation& evaluation, AlignmentResult& result) {
  evaluation.begin(target, source, options);
  const bool damped_newton = options.optimizer == Optimizer::DAMPED_NEWTON;
  if (damped_newton && options.use_coarse_level && !target.coarse().empty()) {
    alignCoarsely(target, options, evaluation, result);
  }
  const StepLimits limits = limitsOf(target, options);
  if (!damped_newton) {
    newtonMoreThuente(evaluation.onMatchingLevels(result.T_map_source), limits, options.line_search_min_step,
                      options.line_search_max_step, result);
  } else if (target.levels().size() > 1) {
    alignOnSeveralLevels(target, options, evaluation, result);
  } else {
    dampedNewton(evaluation.onMatchingLevels(result.T_map_source), limits, options.min_curvature_share, result);
  }
  result.likelihood = result.score / static_cast<double>(source.size());
  if (options.evaluate_likelihoods) result.likelihoods = evaluation.likelihoods(result.T_map_source);
  assessAlignment(target, source, options, result);
}

}  // namespace

struct NdtAligner::Scratch {
  NdtEvaluation evaluation;
  SourcePoints moved_source;
};

NdtAligner::NdtAligner() : scratch_(std::make_unique<Scratch>()) {}
NdtAligner::~NdtAligner() = default;
NdtAligner::NdtAligner(const NdtAligner&) : NdtAligner() {}
NdtAligner& NdtAligner::operator=(const NdtAligner&) { return *this; }

AlignmentResult NdtAligner::align(const NdtTarget& target, const SourcePoints& source, const Eigen::Isometry3d& guess,
                                  const AlignmentOptions& options) {
  options.check();
  requireRegistrable(source);
  if (!guess.matrix().allFinite()) throw std::invalid_argument("the initial guess is not finite");
  AlignmentResult result;
  result.T_map_source = guess;
  result.status = target.empty() ? AlignmentStatus::NO_TARGET : AlignmentStatus::NO_SOURCE;
  result.overlap = 0.0;
  if (target.empty() || source.empty()) return result;

  const internal::HelperSession session(options.threads);
  if (options.optimizer == Optimizer::DAMPED_NEWTON) result.rotation_centre = rotationCentre(source);
  if (result.rotation_centre.isZero()) {
    alignNear(target, source, options, scratch_->evaluation, result);
    return result;
  }
  moveTo(result.rotation_centre, source, scratch_->moved_source);
  result.T_map_source = guess * Eigen::Translation3d(result.rotation_centre);
  alignNear(target, scratch_->moved_source, options, scratch_->evaluation, result);
  result.T_map_source = result.T_map_source * Eigen::Translation3d(-result.rotation_centre);
  return result;
}

}  // namespace saw_ndt
