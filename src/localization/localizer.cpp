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
  preparation.motion_compensation = options.motion_compensation;
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

BodyMotion mixed(const BodyMotion& a, const BodyMotion& b, double share_of_b) {
  return {a.velocity_mps + share_of_b * (b.velocity_mps - a.velocity_mps),
          a.turn_rate_radps + share_of_b * (b.turn_rate_radps - a.turn_rate_radps)};
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
  global_search.check();
  checkOption(scan_period_s >= 0.0 && std::isfinite(scan_period_s), "scan_period_s", scan_period_s, "0 or more");
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
      finder_(std::make_unique<PoseFinder>(alignerTo(target, options_), target, options_)),
      moving_(makeMoving(options_)) {}

Localizer::Localizer(SourceAligner aligner, const LocalizerOptions& options)
    : options_(withMethod(options)),
      preparation_(preparationOptions(options_)),
      prediction_(options.prediction),
      finder_(std::make_unique<PoseFinder>(std::move(aligner), options_)),
      moving_(makeMoving(options_)) {}

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
  explicit Moving(const LocalizerOptions& options) : motion(options.prediction, options.scan_period_s) {}

  MotionKnowledge motion;
  MovingSource source;
};

std::unique_ptr<Localizer::Moving> Localizer::makeMoving(const LocalizerOptions& options) {
  return options.motion_compensation != MotionCompensation::OFF ? std::make_unique<Moving>(options) : nullptr;
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

void Localizer::setUnknownPose() {
  if (!finder_->canSearch()) throw std::logic_error("setUnknownPose: there is no search, or no target to search in");
  prediction_.resetUnknown();
  if (moving_) moving_->motion.forget();
  if (ongoing_search_) ongoing_search_->outdated = true;
}

void Localizer::setInitialPose(const Eigen::Isometry3d& T_map_base) {
  prediction_.reset(T_map_base);
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

// The found pose as it is by another motion, found again from a start.
PoseAttempt Localizer::compensatedAgain(const PoseAttempt& found, const Eigen::Isometry3d& T_map_base_start,
                                        const ScanMotion& motion, const ScanInWork& scan) {
  const bool is_expected = found.search != SearchExtent::EVERYWHERE;
  const PoseExpectation expected = expectation(scan.predicted, scan.stamp_s);
  PoseAttempt again = finder_->findFrom(moving_->source.compensatedBy(motion), T_map_base_start,
                                        is_expected ? &expected : nullptr, prediction_.state());
  again.search = found.search;
  return again;
}

// The motion by which most of the scan fits the map: the speed straight on is tried out, then corrected together with
// what shakes the vehicle.
PoseAttempt Localizer::withBestMotion(const PoseAttempt& found, const ScanInWork& scan, ScanMotion& motion) {
  constexpr double kFastest_mps = 40.0;
  constexpr double kStep_mps = 8.0;
  const Vector6d kSteps = (Vector6d() << 3.0, 0.0, 0.3, 0.0, 0.06, 0.06).finished();  // m/s, rad/s
  constexpr int kRounds = 2;
  constexpr double kFinerStep = 0.35;
  struct Trial {
    Vector6d rates = Vector6d::Zero();  // velocity, turn rate
    double fit = -1.0;
    Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();
  };
  const auto evenMotion = [](const Vector6d& rates) { return ScanMotion::even({rates.head<3>(), rates.tail<3>()}); };
  const auto tried = [&](const Vector6d& rates, const Eigen::Isometry3d& start) {
    const AlignmentResult alignment = finder_->align(moving_->source.compensatedBy(evenMotion(rates)), start);
    const double fit = alignment.converged() ? alignment.likelihoods.unweighted * alignment.overlap : -1.0;
    return Trial{rates, fit, alignment.T_map_source};
  };
  // Where the scan was found as it is may be off by half the way of the turn.
  Trial best;
  best.T_map_base = found.alignment.T_map_source;
  Eigen::Isometry3d start = best.T_map_base;
  for (double speed_mps = 0.0; speed_mps <= kFastest_mps; speed_mps += kStep_mps) {
    Trial trial = tried(speed_mps * Vector6d::UnitX(), start);
    if (found.search == SearchExtent::NONE) {
      const Trial other = tried(speed_mps * Vector6d::UnitX(), scan.predicted.T_map_base);
      if (other.fit > trial.fit) trial = other;
    }
    if (trial.fit > best.fit) best = trial;
    if (trial.fit >= 0.0) start = trial.T_map_base;
  }
  if (best.fit < 0.0) return found;
  for (int round = 0; round < kRounds; ++round) {
    for (int k = 0; k < 6; ++k) {
      const double step = std::pow(kFinerStep, round) * kSteps[k];
      if (step == 0.0) continue;
      const Trial less = tried(best.rates - step * Vector6d::Unit(k), best.T_map_base);
      const Trial more = tried(best.rates + step * Vector6d::Unit(k), best.T_map_base);
      // The summit of the parabola.
      const double bend = less.fit + more.fit - 2.0 * best.fit;
      const double way = bend < 0.0 ? std::clamp(0.5 * (less.fit - more.fit) / bend, -1.0, 1.0) : 0.0;
      const Trial summit = tried(best.rates + way * step * Vector6d::Unit(k), best.T_map_base);
      for (const Trial& trial : {less, more, summit}) {
        if (trial.fit > best.fit) best = trial;
      }
      if (getenv("DBG"))
        fprintf(stderr, "best %d %d fit %g rates %g %g %g %g %g %g\n", round, k, best.fit, best.rates[0], best.rates[1],
                best.rates[2], best.rates[3], best.rates[4], best.rates[5]);
    }
  }
  motion = evenMotion(best.rates);
  const PoseAttempt again = compensatedAgain(found, best.T_map_base, motion, scan);
  return again.accepted() || !found.accepted() ? again : found;
}

// By the motion that is expected and, where that turns out to be another, by what was found.
PoseAttempt Localizer::locateMoving(const SourcePoints& measured, const ScanPriors& priors, ScanInWork& scan) {
  constexpr double kSettledShift_m = 0.01;
  constexpr int kMostRepetitions = 2;
  MovingSource& source = moving_->source;
  source.take(measured, preparation_.times_s());
  if (!source.hasTimes()) return locate(measured, scan);
  const TrackState& track = prediction_.state();
  const std::optional<ScanMotion> expected = moving_->motion.expected(track, priors);
  ScanMotion motion = expected.value_or(ScanMotion());
  PoseAttempt found = locate(source.compensatedBy(motion), scan);
  const bool is_unknown = !expected || (found.search == SearchExtent::EVERYWHERE && !priors.motion);
  if (is_unknown && found.alignment.converged()) found = withBestMotion(found, scan, motion);
  for (int k = 0; k < kMostRepetitions && found.accepted() && found.search != SearchExtent::EVERYWHERE; ++k) {
    const std::optional<ScanMotion> moved = moving_->motion.motionTo(found.T_map_base, track);
    if (!moved || priors.motion) break;
    // Points moved too far on the whole have set the pose back, of which the motion then tells too little.
    const double share = 1.0 / (1.0 + source.meanTime_s() / *moving_->motion.elapsed_s(track));
    const ScanMotion better{mixed(motion.before, moved->before, share), mixed(motion.after, moved->after, share)};
    if (getenv("DBG"))
      fprintf(stderr, "scan %.2f motion %.3f %.3f %.3f w %.4f %.4f %.4f moved %.3f %.3f %.3f w %.4f %.4f %.4f\n",
              scan.stamp_s, motion.before.velocity_mps.x(), motion.before.velocity_mps.y(),
              motion.before.velocity_mps.z(), motion.before.turn_rate_radps.x(), motion.before.turn_rate_radps.y(),
              motion.before.turn_rate_radps.z(), moved->before.velocity_mps.x(), moved->before.velocity_mps.y(),
              moved->before.velocity_mps.z(), moved->after.turn_rate_radps.x(), moved->after.turn_rate_radps.y(),
              moved->after.turn_rate_radps.z());
    if (shiftBetween(better, motion, source.reach_s()) < kSettledShift_m) break;
    const PoseAttempt again = compensatedAgain(found, found.alignment.T_map_source, better, scan);
    if (!again.accepted()) break;
    motion = better;
    found = again;
  }
  if (found.accepted()) moving_->motion.learn(motion);
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
  result.times.total_ms = work.since_start.milliseconds();
  return result;
}

}  // namespace saw_ndt
