#include "saw_ndt/localization/localizer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>
#include <stdexcept>
#include <utility>

#include "common/executor.h"
#include "common/stopwatch.h"
#include "localization/pose_finder.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"

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

// A map may be of another vehicle: where its LiDAR was and what of it was seen does not matter.
SegmentationOptions mountedAs(SegmentationOptions options, const SegmentationOptions& other) {
  options.mounting_pitch_deg = other.mounting_pitch_deg;
  options.mounting_roll_deg = other.mounting_roll_deg;
  options.min_range_m = other.min_range_m;
  options.max_range_m = other.max_range_m;
  options.vehicle_box_m = other.vehicle_box_m;
  options.ground.sensor_height_m = other.ground.sensor_height_m;
  return options;
}

void requireSegmentedAlike(const MapOrigin& origin, const LocalizerOptions& options) {
  if (!options.method.segment || options.allow_other_segmentation || !origin.segmentation) return;
  if (const auto difference =
          firstDifference(mountedAs(*origin.segmentation, options.segmentation), options.segmentation)) {
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
  global_search.check();
  checkOption(search_budget_ms > 0.0, "search_budget_ms", search_budget_ms, "positive");
  preparationOptions(*this).check();
}

Localizer::Localizer(const WeightedVoxelMap& map, const LocalizerOptions& options)
    : Localizer(NdtTarget(map, options.method.voxels, options.alignment.threads), options) {}

Localizer::Localizer(const std::string& map_file, const LocalizerOptions& options)
    : Localizer(NdtTarget::load(map_file, options.method.voxels, options.alignment.threads), options) {}

Localizer::Localizer(const NdtTarget& target, const LocalizerOptions& options)
    : options_(withMethod(options)),
      preparation_(preparationOptions(options_)),
      prediction_(options.prediction),
      finder_(std::make_unique<PoseFinder>(alignerTo(target, options_), target, options_)) {}

Localizer::Localizer(SourceAligner aligner, const LocalizerOptions& options)
    : options_(withMethod(options)),
      preparation_(preparationOptions(options_)),
      prediction_(options.prediction),
      finder_(std::make_unique<PoseFinder>(std::move(aligner), options_)) {}

// A search in a thread of its own.
struct Localizer::OngoingSearch {
  double stamp_s = 0.0;   // of the scan that is looked for
  bool outdated = false;  // the vehicle has been found in another way
  std::future<PoseAttempt> found;
};

Localizer::~Localizer() = default;
Localizer::Localizer(Localizer&& other) noexcept = default;
Localizer& Localizer::operator=(Localizer&& other) noexcept = default;

const char* toString(SearchExtent extent) {
  switch (extent) {
    case SearchExtent::NONE:
      return "";
    case SearchExtent::AROUND:
      return "around";
    case SearchExtent::EVERYWHERE:
      return "everywhere";
  }
  return "unknown";
}

void Localizer::setUnknownPose() {
  if (!finder_->canSearch()) throw std::logic_error("setUnknownPose: there is no search, or no target to search in");
  prediction_.resetUnknown();
  if (ongoing_search_) ongoing_search_->outdated = true;
}

void Localizer::setInitialPose(const Eigen::Isometry3d& T_map_base) {
  prediction_.reset(T_map_base);
  if (ongoing_search_) ongoing_search_->outdated = true;
}

PoseAttempt Localizer::find(const SourcePoints& source, const UncertainPose& predicted, double stamp_s) {
  const TrackState& track = prediction_.state();
  const PoseExpectation expectation = finder_->judge().expect(predicted.T_map_base, predicted.covariance, track,
                                                              stamp_s, options_.prediction.max_turn_rate_radps);
  return finder_->find(source, expectation, track);
}

// Within the budget; what is found later is where the vehicle was, from which the next scan goes on.
PoseAttempt Localizer::searchEverywhere(const SourcePoints& source, double stamp_s, double elapsed_ms) {
  if (std::isinf(options_.search_budget_ms)) return finder_->findAnywhere(source, prediction_.state());
  PoseAttempt none;
  none.search = SearchExtent::EVERYWHERE;
  const auto isReady = [&](double wait_ms) {
    return ongoing_search_->found.wait_for(std::chrono::duration<double, std::milli>(wait_ms)) ==
           std::future_status::ready;
  };
  if (ongoing_search_ && ongoing_search_->outdated && isReady(0.0)) ongoing_search_.reset();
  if (!ongoing_search_) {
    ongoing_search_ = std::make_unique<OngoingSearch>();
    ongoing_search_->stamp_s = stamp_s;
    ongoing_search_->found =
        std::async(std::launch::async, [finder = *finder_, source, track = prediction_.state()]() mutable {
          return finder.findAnywhere(source, track);
        });
  }
  if (ongoing_search_->outdated || !isReady(std::max(0.0, options_.search_budget_ms - elapsed_ms))) return none;
  const PoseAttempt found = ongoing_search_->found.get();
  const double found_stamp_s = ongoing_search_->stamp_s;
  ongoing_search_.reset();
  if (found_stamp_s == stamp_s || !found.accepted()) return found;
  MeasuredPose pose{found.T_map_base, found.alignment.covariance, found.alignment.free_directions};
  pose.overlap = found.alignment.overlap;
  prediction_.restart(pose, found_stamp_s);
  prediction_.move(std::nullopt);  // the motion since then is not at hand
  return none;
}

// The prediction with a measured position. Where the vehicle is lost, that alone may be right.
UncertainPose Localizer::predictedPose(double stamp_s, const std::optional<MeasuredPosition>& position,
                                       bool& without_track) const {
  UncertainPose predicted{prediction_.predict(stamp_s), prediction_.predictedCovariance(stamp_s)};
  if (!position) return predicted;
  if (const auto corrected = correctedBy(*position, predicted)) return *corrected;
  if (!prediction_.state().isLost()) return predicted;
  without_track = true;
  return correctedBy(*position, {predicted.T_map_base, anywhereCovariance()}).value_or(predicted);
}

UncertainPose Localizer::accept(const PoseAttempt& found, double stamp_s,
                                const std::optional<MeasuredPosition>& position, bool without_track) {
  MeasuredPose pose{found.T_map_base, found.alignment.covariance, found.alignment.free_directions};
  if (std::isfinite(found.alignment.overlap)) pose.overlap = found.alignment.overlap;
  if (without_track) {
    prediction_.restart(pose, stamp_s);
  } else {
    // Free directions have the position already; it must not be taken for a motion since the last pose.
    if (position) {
      pose.T_map_base = keptAlongFreeDirections(prediction_.predict(stamp_s), found.alignment.T_map_source,
                                                found.alignment.free_directions);
    }
    pose.learn_velocity = !prediction_.isSurprising(pose, stamp_s);
    const Matrix6d covariance = prediction_.accept(pose, stamp_s);
    if (prediction_.state().stamp_s != stamp_s) return {found.T_map_base, covariance};  // it came late
  }
  if (position) prediction_.correct(*position);
  return {prediction_.state().T_map_base, prediction_.state().covariance};
}

LocalizationResult Localizer::localize(const ScanView& scan, double stamp_s, const ScanPriors& priors) {
  const internal::Stopwatch total;
  const internal::HelperSession session(options_.alignment.threads);
  LocalizationResult result;
  result.stamp_s = stamp_s;
  prediction_.move(priors.motion);
  bool without_track = !prediction_.state().pose_known;
  const UncertainPose predicted = predictedPose(stamp_s, priors.position, without_track);
  result.T_map_base_predicted = predicted.T_map_base;
  const SourcePoints& source = preparation_.prepare(scan);
  result.source_points = source.size();
  result.times.segment_ms = preparation_.segmentMilliseconds();
  result.times.filter_ms = preparation_.filterMilliseconds();

  const internal::Stopwatch alignment;
  PoseAttempt found = find(source, predicted, stamp_s);
  if (!found.accepted() && priors.position && !without_track) {
    // The position may be an outlier that nobody could tell.
    const PoseAttempt other =
        find(source, {prediction_.predict(stamp_s), prediction_.predictedCovariance(stamp_s)}, stamp_s);
    if (other.accepted()) found = other;
  }
  const bool is_lost = prediction_.state().isLost() || !PoseFinder::isInReach(predicted.covariance);
  if (is_lost && finder_->isWorthSearching(found, prediction_.state())) {
    const PoseAttempt other = searchEverywhere(source, stamp_s, total.milliseconds());
    found.search = other.search;
    if (other.accepted() || without_track) found = other;
  } else if (ongoing_search_) {
    ongoing_search_->outdated = true;
  }
  result.times.align_ms = alignment.milliseconds();

  result.alignment = found.alignment;
  result.correction = correctionOf(result.T_map_base_predicted, found.alignment.T_map_source);
  result.acceptance = found.acceptance;
  result.search = found.search;
  if (result.accepted()) {
    result.free_directions = found.alignment.free_directions;
    without_track = without_track || found.search == SearchExtent::EVERYWHERE;
    const UncertainPose accepted = accept(found, stamp_s, priors.position, without_track);
    result.T_map_base = accepted.T_map_base;
    result.covariance = accepted.covariance;
  } else {
    // That before, unless a search has just told where the vehicle was.
    const UncertainPose expected = predictedPose(stamp_s, priors.position, without_track);
    result.T_map_base = expected.T_map_base;
    result.covariance = expected.covariance;
    prediction_.reject(stamp_s, found.search == SearchExtent::EVERYWHERE);
  }
  result.track = prediction_.state();
  result.times.total_ms = total.milliseconds();
  return result;
}

}  // namespace saw_ndt
