#include "saw_ndt/localization/localizer.h"

#include <Eigen/LU>
#include <stdexcept>
#include <utility>

#include "common/executor.h"
#include "common/stopwatch.h"

namespace saw_ndt {

using namespace internal;

namespace {

Matrix6d inverseOrZero(const Matrix6d& information) {
  const Eigen::FullPivLU<Matrix6d> decomposition(information);
  return decomposition.isInvertible() ? Matrix6d(decomposition.inverse()) : Matrix6d(Matrix6d::Zero());
}

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
  options.alignment.evaluate_likelihoods = true;
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
    : Localizer(alignerTo(target, options), options) {}

Localizer::Localizer(SourceAligner aligner, const LocalizerOptions& options)
    : options_(withMethod(options)),
      preparation_(preparationOptions(options_)),
      prediction_(options.prediction),
      aligner_(std::move(aligner)),
      judge_(options.acceptance) {}

LocalizationResult Localizer::localize(const ScanView& scan, double stamp_s) {
  const internal::Stopwatch total;
  const internal::HelperSession session(options_.alignment.threads);
  LocalizationResult result;
  result.stamp_s = stamp_s;
  result.T_map_base_predicted = prediction_.predict(stamp_s);
  const SourcePoints& source = preparation_.prepare(scan);
  result.source_points = source.size();
  result.times.segment_ms = preparation_.segmentMilliseconds();
  result.times.filter_ms = preparation_.filterMilliseconds();

  const internal::Stopwatch alignment;
  result.alignment = aligner_(source, result.T_map_base_predicted);
  result.times.align_ms = alignment.milliseconds();

  result.correction = correctionOf(result.T_map_base_predicted, result.alignment.T_map_source);
  result.acceptance = judge_.judge(result.alignment, result.correction, prediction_.state(), stamp_s);
  if (result.accepted()) {
    result.T_map_base = result.alignment.T_map_source;
    result.covariance = inverseOrZero(result.alignment.information);
    prediction_.accept(result.T_map_base, stamp_s);
  } else {
    result.T_map_base = result.T_map_base_predicted;
    prediction_.reject();
  }
  result.track = prediction_.state();
  result.times.total_ms = total.milliseconds();
  return result;
}

}  // namespace saw_ndt
