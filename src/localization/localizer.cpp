#include "saw_ndt/localization/localizer.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/executor.h"
#include "common/stopwatch.h"
#include "localization/rival_poses.h"

namespace saw_ndt {

using namespace internal;

namespace {

ScanPreparationOptions preparationOptions(const LocalizerOptions& options) {
  ScanPreparationOptions preparation;
  preparation.segment = options.method.segment;
  preparation.segmentation = options.segmentation;
  preparation.ground_ratio = options.method.ground_ratio;
  preparation.confidence = options.method.voxels.confidence;
  preparation.source_voxel_size_m = options.source_voxel_size_m;
  preparation.T_base_lidar = options.T_base_lidar;
  preparation.threads = options.alignment.threads;
  return preparation;
}

LocalizerOptions withMethod(LocalizerOptions options) {
  options.check();
  options.alignment.use_weights = options.method.use_weights;
  options.alignment.mismatch_penalty = options.method.mismatch_penalty;
  options.alignment.outlier_ratio = options.method.outlier_ratio;
  options.alignment.coarse_settled_voxels = options.method.coarse_settled_voxels;
  options.alignment.ground_in_own_column = options.method.ground_in_own_column;
  options.alignment.covariance_scale = options.method.covariance_scale;
  options.alignment.evaluate_likelihoods = true;
  options.alignment.min_overlap = options.acceptance.min_overlap;
  return options;
}

void requireSegmentedAlike(const MapOrigin& origin, const LocalizerOptions& options) {
  if (!options.method.segment || options.allow_other_segmentation || !origin.segmentation) return;
  if (const auto difference = firstDifference(*origin.segmentation, options.segmentation)) {
    throw std::invalid_argument("segmentation." + difference->field + " = " + difference->second +
                                ": the scans of the map were segmented with " + difference->first);
  }
}

SourceAligner alignerTo(const NdtTarget& target, const LocalizerOptions& options) {
  if (options.method.segment && !target.labelled()) {
    throw std::invalid_argument("Localizer: method " + options.method.name +
                                " needs a map with labels, and this one was built without");
  }
  if (!(target.weighting() == options.method.voxels)) {
    throw std::invalid_argument("Localizer: the target was made with another VoxelWeighting than that of method " +
                                options.method.name + ": make it with LocalizationMethod::voxels");
  }
  requireSegmentedAlike(target.origin(), options);
  return [target, alignment = withMethod(options).alignment, aligner = NdtAligner()](
             const SourcePoints& source, const Eigen::Isometry3d& T_map_base_predicted) mutable {
    return aligner.align(target, source, T_map_base_predicted, alignment);
  };
}

}  // namespace

void LocalizerOptions::check() const {
  method.check();
  prediction.check();
  alignment.check();
  acceptance.check();
  preparationOptions(*this).check();
}

Localizer::Localizer(const WeightedVoxelMap& map, const LocalizerOptions& options)
    : Localizer(NdtTarget(map, options.method.voxels, options.alignment.threads), options) {}

Localizer::Localizer(const std::string& map_file, const LocalizerOptions& options)
    : Localizer(NdtTarget::load(map_file, options.method.voxels, options.alignment.threads), options) {}

Localizer::Localizer(const NdtTarget& target, const LocalizerOptions& options)
    : Localizer(alignerTo(target, options), options) {
  target_ = target;
}

Localizer::Localizer(SourceAligner aligner, const LocalizerOptions& options)
    : options_(withMethod(options)),
      preparation_(preparationOptions(options_)),
      prediction_(options.prediction),
      aligner_(std::move(aligner)),
      judge_(options.acceptance) {}

// An alignment from one start, and what is thought of it.
struct Localizer::Attempt {
  AlignmentResult alignment;
  Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();
  Acceptance acceptance = Acceptance::NOT_CONVERGED;

  bool accepted() const { return acceptance == Acceptance::ACCEPTED; }
};

Localizer::Attempt Localizer::attempt(const SourcePoints& source, const Eigen::Isometry3d& T_map_base_start,
                                      const PoseExpectation& expectation) {
  Attempt result;
  result.alignment = aligner_(source, T_map_base_start);
  result.T_map_base =
      keptAlongFreeDirections(expectation.T_map_base, result.alignment.T_map_source, result.alignment.free_directions);
  result.acceptance = judge_.judge(result.alignment, result.T_map_base, expectation);
  return result;
}

Localizer::Attempt Localizer::withoutRivals(const SourcePoints& source, const Attempt& found,
                                            const PoseExpectation& expectation) {
  const double min_advantage_sigmas = options_.acceptance.min_advantage_sigmas;
  if (!target_ || min_advantage_sigmas == 0.0) return found;
  constexpr double kLeastRadius_m = 5.0;
  constexpr double kSigmas = 3.0;
  const double sigma_m = std::sqrt(expectation.covariance.diagonal().head<2>().maxCoeff());
  const double radius_m = std::max(kLeastRadius_m, std::min(kSigmas * sigma_m, kSigmas * kFreeSigma_m));
  Attempt best = found;
  bool ambiguous = false;
  for (const Eigen::Isometry3d& start :
       internal::rivalPoses(*target_, source, found.alignment, radius_m, options_.alignment.threads)) {
    const Attempt rival = attempt(source, start, expectation);
    // A rival that is free along that way as well keeps to the same place.
    const double apart_m = (rival.T_map_base.translation() - best.T_map_base.translation()).norm();
    if (!rival.alignment.converged() || apart_m < internal::kOtherPlace_m) continue;
    const double sigmas = internal::advantage(*target_, source, best.T_map_base, rival.T_map_base);
    if (std::abs(sigmas) < min_advantage_sigmas) ambiguous = true;
    if (sigmas < 0.0) best = rival;
  }
  if (ambiguous) best.acceptance = Acceptance::AMBIGUOUS;
  return best;
}

Localizer::Attempt Localizer::find(const SourcePoints& source, const PoseExpectation& expectation) {
  const TrackState& track = prediction_.state();
  Attempt found = attempt(source, expectation.T_map_base, expectation);
  // The motion may have been a wrong one.
  const double away_m = (track.T_map_base.translation() - expectation.T_map_base.translation()).norm();
  if (!found.accepted() && track.stamp_s && away_m > kOtherPlace_m) {
    const Attempt again = attempt(source, track.T_map_base, expectation);
    if (again.accepted()) found = again;
  }
  if (!found.accepted() || !judge_.isDoubtful(found.alignment, found.T_map_base, expectation, track)) return found;
  found = withoutRivals(source, found, expectation);
  if (found.accepted()) found.acceptance = judge_.judgeDoubtful(found.alignment, track);
  return found;
}

LocalizationResult Localizer::localize(const ScanView& scan, double stamp_s) {
  const internal::Stopwatch total;
  const internal::HelperSession session(options_.alignment.threads);
  LocalizationResult result;
  result.stamp_s = stamp_s;
  result.T_map_base_predicted = prediction_.predict(stamp_s);
  const PoseExpectation expectation =
      judge_.expect(result.T_map_base_predicted, prediction_.predictedCovariance(stamp_s), prediction_.state(), stamp_s,
                    options_.prediction.max_turn_rate_radps);
  const SourcePoints& source = preparation_.prepare(scan);
  result.source_points = source.size();
  result.times.segment_ms = preparation_.segmentMilliseconds();
  result.times.filter_ms = preparation_.filterMilliseconds();

  const internal::Stopwatch alignment;
  const Attempt found = find(source, expectation);
  result.times.align_ms = alignment.milliseconds();

  result.alignment = found.alignment;
  result.correction = correctionOf(result.T_map_base_predicted, found.alignment.T_map_source);
  result.acceptance = found.acceptance;
  if (result.accepted()) {
    result.T_map_base = found.T_map_base;
    result.free_directions = found.alignment.free_directions;
    MeasuredPose pose{found.T_map_base, found.alignment.covariance, found.alignment.free_directions};
    pose.learn_velocity = !judge_.isSurprising(found.alignment, found.T_map_base, expectation);
    if (std::isfinite(found.alignment.overlap)) pose.overlap = found.alignment.overlap;
    prediction_.accept(pose, stamp_s);
    result.covariance = prediction_.state().covariance;
  } else {
    result.T_map_base = result.T_map_base_predicted;
    result.covariance = expectation.covariance;
    prediction_.reject();
  }
  result.track = prediction_.state();
  result.times.total_ms = total.milliseconds();
  return result;
}

}  // namespace saw_ndt
