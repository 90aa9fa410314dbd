#include "saw_ndt/localization/localizer.h"

#include <Eigen/LU>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "common/threads.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {
namespace {

class Stopwatch {
 public:
  double milliseconds() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

Matrix6d inverseOrZero(const Matrix6d& information) {
  const Eigen::FullPivLU<Matrix6d> decomposition(information);
  return decomposition.isInvertible() ? Matrix6d(decomposition.inverse()) : Matrix6d(Matrix6d::Zero());
}

Acceptance judge(const LocalizationResult& result, const AcceptanceOptions& limits,
                 const MotionPrediction& prediction) {
  double max_correction_m = limits.max_correction_m;
  if (!prediction.velocityKnown()) {
    const double elapsed_s = std::max(0.0, prediction.timeSinceLast(result.stamp_s).value_or(0.0));
    max_correction_m = std::max(max_correction_m, limits.max_unknown_speed_mps * elapsed_s);
  }
  if (!result.alignment.converged()) return Acceptance::NOT_CONVERGED;
  if (!(result.likelihoods.unweighted >= limits.min_likelihood)) return Acceptance::LOW_LIKELIHOOD;
  if (!(result.correction_m <= max_correction_m)) return Acceptance::LARGE_TRANSLATION;
  if (!(degreesFromRadians(result.correction_rad) <= limits.max_correction_deg)) return Acceptance::LARGE_ROTATION;
  return Acceptance::ACCEPTED;
}

}  // namespace

void AcceptanceOptions::check() const {
  checkOption(min_likelihood >= 0.0, "min_likelihood", min_likelihood, "0 or more");
  checkOption(max_correction_m > 0.0, "max_correction_m", max_correction_m, "positive");
  checkOption(max_correction_deg > 0.0, "max_correction_deg", max_correction_deg, "positive");
  checkOption(max_unknown_speed_mps >= 0.0, "max_unknown_speed_mps", max_unknown_speed_mps, "0 or more");
}

void LocalizerOptions::check() const {
  method.check();
  segmentation.check();
  prediction.check();
  alignment.check();
  acceptance.check();
  checkOption(source_voxel_size_m >= 0.0 && std::isfinite(source_voxel_size_m), "source_voxel_size_m",
              source_voxel_size_m, "0 or more");
  const Eigen::Matrix3d& R = T_base_lidar.linear();
  if (!T_base_lidar.matrix().allFinite() || !R.isUnitary(1e-6) || R.determinant() < 0.0) {
    throw std::invalid_argument("T_base_lidar: must be a finite rigid transform");
  }
}

const char* toString(Acceptance acceptance) {
  switch (acceptance) {
    case Acceptance::ACCEPTED:
      return "accepted";
    case Acceptance::NOT_CONVERGED:
      return "not converged";
    case Acceptance::LOW_LIKELIHOOD:
      return "low likelihood";
    case Acceptance::LARGE_TRANSLATION:
      return "large translation";
    case Acceptance::LARGE_ROTATION:
      return "large rotation";
  }
  return "unknown";
}

void concludeLocalization(LocalizationResult& result, const AcceptanceOptions& limits, MotionPrediction& prediction) {
  const Eigen::Isometry3d& T_map_aligned = result.alignment.T_map_source;
  const Eigen::Isometry3d T_predicted_aligned = result.T_map_base_predicted.inverse() * T_map_aligned;
  result.correction_m = T_predicted_aligned.translation().norm();
  result.correction_rad = rotationAngle(T_predicted_aligned.linear());
  result.acceptance = judge(result, limits, prediction);
  result.T_map_base = result.accepted() ? T_map_aligned : result.T_map_base_predicted;
  if (result.accepted()) prediction.accept(T_map_aligned, result.stamp_s);
}

Localizer::Localizer(NdtTarget target, const LocalizerOptions& options)
    : target_(std::move(target)),
      options_((options.check(), options)),
      segmenter_(options.segmentation),
      filter_(options.source_voxel_size_m),
      prediction_(options.prediction) {
  if (options_.method.segment && !target_.labelled()) {
    throw std::invalid_argument("Localizer: method " + options_.method.name +
                                " needs a map with labels, and this one was built without");
  }
  if (!(target_.weighting() == options_.method.voxels)) {
    throw std::invalid_argument("Localizer: the target was made with another VoxelWeighting than that of method " +
                                options_.method.name + ": make it with LocalizationMethod::voxels");
  }
  options_.alignment.use_weights = options_.method.use_weights;
  options_.alignment.mismatch_penalty = options_.method.mismatch_penalty;
  options_.alignment.outlier_ratio = options_.method.outlier_ratio;
  options_.alignment.evaluate_likelihoods = true;
}

Localizer::Localizer(const WeightedVoxelMap& map, const LocalizerOptions& options)
    : Localizer(NdtTarget(map, options.method.voxels, options.alignment.threads), options) {}

const SourcePoints& Localizer::makeSource(const ScanView& scan, StageTimes& times) {
  const LocalizationMethod& method = options_.method;
  if (method.segment) {
    const Stopwatch stopwatch;
    segmenter_.segment(scan, labels_, threadCount(options_.alignment.threads));
    times.segment_ms = stopwatch.milliseconds();
  }

  const Stopwatch stopwatch;
  const SourcePoints& source = filter_.filter(scan, method.segment ? &labels_ : nullptr,
                                              {method.ground_ratio, method.voxels.confidence, options_.T_base_lidar});
  times.filter_ms = stopwatch.milliseconds();
  return source;
}

LocalizationResult Localizer::localize(const ScanView& scan, double stamp_s) {
  const Stopwatch total;
  LocalizationResult result;
  result.stamp_s = stamp_s;
  result.T_map_base_predicted = prediction_.predict(stamp_s);
  const SourcePoints& source = makeSource(scan, result.times);
  result.source_points = source.size();

  const Stopwatch alignment;
  result.alignment = aligner_.align(target_, source, result.T_map_base_predicted, options_.alignment);
  result.times.align_ms = alignment.milliseconds();

  result.likelihoods = result.alignment.likelihoods;
  concludeLocalization(result, options_.acceptance, prediction_);
  if (result.accepted()) result.covariance = inverseOrZero(result.alignment.information);
  result.times.total_ms = total.milliseconds();
  return result;
}

}  // namespace saw_ndt
