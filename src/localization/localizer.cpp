#include "saw_ndt/localization/localizer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>
#include <stdexcept>
#include <utility>

#include "common/executor.h"
#include "common/stopwatch.h"
#include "localization/motion_compensation.h"
#include "localization/motion_knowledge.h"
#include "localization/motion_refinement.h"
#include "localization/pose_finder.h"
#include "localization/preparation_options.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "segmentation/segmentation_fields.h"

namespace saw_ndt {

using namespace internal;

ScanPreparationOptions internal::preparationOptions(const LocalizerOptions& options) {
  ScanPreparationOptions preparation;
  preparation.segment = options.method.segment;
  preparation.segmentation = options.segmentation;
  preparation.ground_ratio = options.method.ground_ratio;
  preparation.confidence = options.method.voxels.confidence;
  preparation.source_voxel_size_m = options.source_voxel_size_m;
  preparation.T_base_lidar = options.T_base_lidar;
  preparation.motion_compensation = options.motion_compensation;
  preparation.threads = options.alignment.threads;
  return preparation;
}

namespace {

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

// How well poses explain scans that are compensated by different motions. The score alone would draw points to where
// the map is coarse.
double fitOf(const AlignmentResult& alignment) {
  return alignment.converged() ? alignment.likelihoods.unweighted * alignment.overlap : -1.0;
}

void requireSegmentedAlike(const MapOrigin& origin, const LocalizerOptions& options) {
  if (!options.method.segment || options.allow_other_segmentation || !origin.segmentation) return;
  if (const auto difference =
          firstDifference(mountedAs(*origin.segmentation, options.segmentation), options.segmentation)) {
    throw std::invalid_argument("segmentation." + difference->field + " = " + difference->second +
                                ": the scans of the map were segmented with " + difference->first);
  }
}

const TiledTarget& checkedTarget(const TiledTarget& target, const LocalizerOptions& options) {
  if (options.method.segment && !target.labelled()) {
    throw std::invalid_argument("Localizer: method " + options.method.name +
                                " needs a map with labels, and this one was built without");
  }
  if (!(target.weighting() == options.method.voxels)) {
    throw std::invalid_argument("Localizer: the target was made with another VoxelWeighting than that of method " +
                                options.method.name + ": make it with LocalizationMethod::voxels");
  }
  requireSegmentedAlike(target.origin(), options);
  return target;
}

}  // namespace

ScanPreparationOptions internal::preparationFor(const TiledTarget& target, const LocalizerOptions& options) {
  ScanPreparationOptions preparation = preparationOptions(options);
  preparation.max_reach_m = target.reach();
  return preparation;
}

void LocalizerOptions::check() const {
  method.check();
  prediction.check();
  alignment.check();
  acceptance.check();
  global_search.check();
  tiles.check();
  checkOption(scan_period_s >= 0.0 && std::isfinite(scan_period_s), "scan_period_s", scan_period_s, "0 or more");
  checkOption(search_budget_ms > 0.0, "search_budget_ms", search_budget_ms, "positive");
  preparationOptions(*this).check();
}

Localizer::Localizer(const WeightedVoxelMap& map, const LocalizerOptions& options)
    : Localizer(NdtTarget(map, options.method.voxels, options.alignment.threads), options) {}

Localizer::Localizer(const std::string& map_file, const LocalizerOptions& options)
    : Localizer(TiledTarget::open(map_file, options.method.voxels, options.tiles, options.alignment.threads), options) {
}

Localizer::Localizer(const NdtTarget& target, const LocalizerOptions& options)
    : Localizer(TiledTarget(target), options) {}

Localizer::Localizer(const TiledTarget& target, const LocalizerOptions& options)
    : options_(withMethod(options)),
      preparation_(preparationFor(target, options_)),
      prediction_(options.prediction),
      finder_(std::make_unique<PoseFinder>(checkedTarget(target, options_), options_)),
      moving_(makeMoving(options_, true)) {}

Localizer::Localizer(SourceAligner aligner, const LocalizerOptions& options)
    : options_(withMethod(options)),
      preparation_(preparationOptions(options_)),
      prediction_(options.prediction),
      finder_(std::make_unique<PoseFinder>(std::move(aligner), options_)),
      moving_(makeMoving(options_, false)) {}

// A scan on its way through localize().
struct Localizer::ScanInWork {
  Stopwatch since_start;
  double stamp_s = 0.0;
  UncertainPose predicted;
  bool has_position = false;   // the prediction was corrected by a measured one
  bool without_track = false;  // what is known of the vehicle does not help
};

// What is needed where the motion of the LiDAR skews scans.
struct Localizer::Moving {
  Moving(const LocalizerOptions& options, bool refines) : motion(options.prediction, options.scan_period_s) {
    if (refines) refinement.emplace(options.alignment);
  }

  MotionKnowledge motion;
  MovingSource source;
  std::optional<MotionRefinement> refinement;  // not with an aligner of another kind
};

std::unique_ptr<Localizer::Moving> Localizer::makeMoving(const LocalizerOptions& options, bool refines) {
  if (options.motion_compensation == MotionCompensation::OFF) return nullptr;
  return std::make_unique<Moving>(options, refines);
}

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

const TileLoads* Localizer::tileLoads() const { return finder_->tileLoads(); }

void Localizer::setUnknownPose() {
  if (!finder_->canSearch()) throw std::logic_error("setUnknownPose: there is no search, or no target to search in");
  prediction_.resetUnknown();
  if (moving_) moving_->motion.forget();
  if (ongoing_search_) ongoing_search_->outdated = true;
}

void Localizer::setInitialPose(const Eigen::Isometry3d& T_map_base) {
  prediction_.reset(T_map_base);
  finder_->loadAhead(T_map_base, Eigen::Vector3d::Zero());
  if (moving_) moving_->motion.forget();
  if (ongoing_search_) ongoing_search_->outdated = true;
}

PoseExpectation Localizer::expectation(const UncertainPose& predicted, double stamp_s) const {
  return finder_->judge().expect(predicted.T_map_base, predicted.covariance, prediction_.state(), stamp_s,
                                 options_.prediction.max_turn_rate_radps);
}

PoseAttempt Localizer::find(const SourcePoints& source, const UncertainPose& predicted, double stamp_s) {
  return finder_->find(source, expectation(predicted, stamp_s), prediction_.state());
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

PoseAttempt Localizer::locate(const SourcePoints& source, ScanInWork& scan) {
  PoseAttempt found = find(source, scan.predicted, scan.stamp_s);
  if (!found.accepted() && scan.has_position && !scan.without_track) {
    // The position may be an outlier that nobody could tell.
    const PoseAttempt other =
        find(source, {prediction_.predict(scan.stamp_s), prediction_.predictedCovariance(scan.stamp_s)}, scan.stamp_s);
    if (other.accepted()) found = other;
  }
  const bool is_lost = prediction_.state().isLost() || !PoseFinder::isInReach(scan.predicted.covariance);
  if (is_lost && finder_->isWorthSearching(found, prediction_.state())) {
    const PoseAttempt other = searchEverywhere(source, scan.stamp_s, scan.since_start.milliseconds());
    found.search = other.search;
    if (other.accepted() || scan.without_track) found = other;
  } else if (ongoing_search_) {
    ongoing_search_->outdated = true;
  }
  return found;
}

// A vehicle of which no speed is known yet may have any straight on: the one at which the scan fits the map best.
std::optional<RefinedMotion> Localizer::refinedAtAnySpeed(const Eigen::Isometry3d& T_map_base_start,
                                                          const MotionPrior& prior) {
  constexpr double kFastest_mps = 40.0;
  constexpr double kStep_mps = 10.0;
  Moving& moving = *moving_;
  std::optional<RefinedMotion> best;
  double best_fit = 0.0;
  Eigen::Isometry3d start = T_map_base_start;
  for (double speed_mps = 0.0; speed_mps <= kFastest_mps; speed_mps += kStep_mps) {
    const ScanMotion motion = ScanMotion::even({speed_mps * Eigen::Vector3d::UnitX(), Eigen::Vector3d::Zero()});
    const AlignmentResult alignment = finder_->align(moving.source.compensatedBy(motion), start);
    if (!alignment.converged()) continue;
    start = alignment.T_map_source;
    const auto refined = moving.refinement->refine(finder_->targetAt(start), moving.source, start, motion, prior);
    if (!refined) continue;
    const double fit = fitOf(finder_->align(moving.source.compensatedBy(refined->motion), refined->T_map_base));
    if (fit <= best_fit) continue;
    best_fit = fit;
    best = refined;
  }
  return best;
}

// A scan that was found by one motion, again by that with which it fits best.
PoseAttempt Localizer::refined(const PoseAttempt& found, const ScanPriors& priors, const ScanInWork& scan,
                               std::optional<ScanMotion>& motion) {
  constexpr double kNegligibleShift_m = 0.01;
  Moving& moving = *moving_;
  const TrackState& track = prediction_.state();
  const bool is_elsewhere = found.search == SearchExtent::EVERYWHERE;
  const MotionPrior prior = moving.motion.prior(track, priors, is_elsewhere);
  const bool is_unknown = !prior.before && (!motion || is_elsewhere);
  const ScanMotion known = motion.value_or(ScanMotion());
  // A skewed scan may have led away from the pose that was expected.
  const bool is_misled = !found.accepted() && PoseFinder::isInReach(scan.predicted.covariance);
  const Eigen::Isometry3d& T_map_base_start = is_misled ? scan.predicted.T_map_base : found.alignment.T_map_source;
  const std::optional<RefinedMotion> refined =
      is_unknown ? refinedAtAnySpeed(T_map_base_start, prior)
                 : moving.refinement->refine(finder_->targetAt(found.alignment.T_map_source), moving.source,
                                             found.alignment.T_map_source, known, prior);
  const bool is_other = refined && refined->significant &&
                        shiftBetween(refined->motion, known, moving.source.reach_s()) >= kNegligibleShift_m;
  if (!is_other) return found;
  const PoseExpectation expected = expectation(scan.predicted, scan.stamp_s);
  PoseAttempt again = finder_->findFrom(moving.source.compensatedBy(refined->motion), refined->T_map_base,
                                        is_elsewhere ? nullptr : &expected, track);
  if (fitOf(again.alignment) < fitOf(found.alignment) || (found.accepted() && !again.accepted())) return found;
  again.search = found.search;
  motion = refined->motion;
  return again;
}

// By the motion that is expected, and then by the one that is found.
PoseAttempt Localizer::locateMoving(const SourcePoints& measured, const ScanPriors& priors, ScanInWork& scan) {
  Moving& moving = *moving_;
  moving.source.take(measured, preparation_.times_s());
  if (!moving.source.hasTimes()) return locate(measured, scan);
  std::optional<ScanMotion> motion = moving.motion.expected(prediction_.state(), priors);
  PoseAttempt found = locate(moving.source.compensatedBy(motion.value_or(ScanMotion())), scan);
  // As it is, a scan at a speed that is not known may lie nowhere.
  const bool is_anywhere = !motion && PoseFinder::isInReach(scan.predicted.covariance);
  if ((found.alignment.converged() || is_anywhere) && moving.refinement) found = refined(found, priors, scan, motion);
  if (found.accepted()) moving.motion.learn(motion.value_or(ScanMotion()));
  return found;
}

LocalizationResult Localizer::localize(const ScanView& scan, double stamp_s, const ScanPriors& priors) {
  ScanInWork work;
  const internal::HelperSession session(options_.alignment.threads);
  LocalizationResult result;
  result.stamp_s = stamp_s;
  prediction_.move(priors.motion);
  bool& without_track = work.without_track;
  without_track = !prediction_.state().pose_known;
  work.stamp_s = stamp_s;
  work.has_position = priors.position.has_value();
  work.predicted = predictedPose(stamp_s, priors.position, without_track);
  result.T_map_base_predicted = work.predicted.T_map_base;
  const SourcePoints& source = preparation_.prepare(scan, moving_ ? moving_->motion.begin(stamp_s) : ScanTiming());
  result.source_points = source.size();
  result.times.segment_ms = preparation_.segmentMilliseconds();
  result.times.filter_ms = preparation_.filterMilliseconds();

  const internal::Stopwatch alignment;
  const PoseAttempt found = moving_ ? locateMoving(source, priors, work) : locate(source, work);
  result.times.align_ms = alignment.milliseconds();
  result.motion_compensated = moving_ && moving_->source.hasTimes();

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
  finder_->loadAhead(result.T_map_base, result.T_map_base.linear() * result.track.velocity_base_mps);
  result.times.total_ms = work.since_start.milliseconds();
  return result;
}

}  // namespace saw_ndt
