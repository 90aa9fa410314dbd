#include "saw_ndt/localization/localizer.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/executor.h"
#include "common/stopwatch.h"
#include "localization/rival_poses.h"
#include "registration/pose_lengths.h"
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
  preparationOptions(*this).check();
}

Localizer::Localizer(const WeightedVoxelMap& map, const LocalizerOptions& options)
    : Localizer(NdtTarget(map, options.method.voxels, options.alignment.threads), options) {}

Localizer::Localizer(const std::string& map_file, const LocalizerOptions& options)
    : Localizer(NdtTarget::load(map_file, options.method.voxels, options.alignment.threads), options) {}

Localizer::Localizer(const NdtTarget& target, const LocalizerOptions& options)
    : Localizer(alignerTo(target, options), options) {
  target_ = target;
  if (options.search) global_search_.emplace(target, options.global_search);
}

Localizer::Localizer(SourceAligner aligner, const LocalizerOptions& options)
    : options_(withMethod(options)),
      preparation_(preparationOptions(options_)),
      prediction_(options.prediction),
      aligner_(std::move(aligner)),
      judge_(options.acceptance) {}

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
  if (!global_search_) throw std::logic_error("setUnknownPose: there is no search, or no target to search in");
  prediction_.resetUnknown();
}

// An alignment from one start, and what is thought of it.
struct Localizer::Attempt {
  AlignmentResult alignment;
  Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();
  Acceptance acceptance = Acceptance::NOT_CONVERGED;

  bool accepted() const { return acceptance == Acceptance::ACCEPTED; }
};

// Where a pose was looked for, and what the search brought to light.
struct Localizer::Search {
  SearchExtent extent = SearchExtent::NONE;
  std::vector<Eigen::Isometry3d> starts;  // to be compared with the pose that is chosen
};

namespace {

// Of the candidates of a search, so many at most are aligned, and none that has less than this share of the cells of
// the best: right ones have 0.6 to 0.9 of the cells of a scan, and the next best in a city 0.5.
constexpr std::size_t kMostAlignedCandidates = 5;
constexpr double kLeastShareOfBest = 0.7;

// The largest region that is searched around a prediction, the smallest one, and the least headings.
constexpr double kGreatestRegion_m = 300.0;
constexpr double kLeastRegion_m = 5.0;
constexpr double kLeastRegion_deg = 15.0;
constexpr double kRegion_sigmas = 3.0;

// How far apart poses are different places (m), beside what free directions tell; and the share of the way along these,
// which may be curved.
constexpr double kOtherPlace_m = 0.3;
constexpr double kCurvedShare = 0.1;

// A vehicle that is faster follows the bend of its road (m/s).
constexpr double kMovingSpeed_mps = 1.0;

// As far around a pose as it is uncertain.
SearchRegion regionOf(const PoseExpectation& expectation) {
  const Matrix6d& covariance = expectation.covariance;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> position(covariance.topLeftCorner<2, 2>(),
                                                                Eigen::EigenvaluesOnly);
  const double sigma_m = std::sqrt(position.eigenvalues().maxCoeff());
  const double sigma_deg = degreesFromRadians(std::sqrt(covariance(5, 5)));
  SearchRegion region;
  region.T_map_base = expectation.T_map_base;
  region.radius_m = std::clamp(kRegion_sigmas * sigma_m, kLeastRegion_m, kGreatestRegion_m);
  region.heading_deg = std::clamp(kRegion_sigmas * sigma_deg, kLeastRegion_deg, 180.0);
  return region;
}

bool isElsewhere(const AlignmentResult& alignment, const Eigen::Isometry3d& T_map_rival) {
  Vector6d away = inLengths(poseDifference(alignment.T_map_source, T_map_rival));
  const Eigen::VectorXd along_free = alignment.free_directions.transpose() * away;
  away -= alignment.free_directions * along_free;
  return away.norm() > kOtherPlace_m + kCurvedShare * along_free.norm();
}

// Adds a direction of translation to those that are free, unless it is one of them.
bool setFree(const Eigen::Vector3d& direction, AlignmentResult& alignment) {
  constexpr double kAlreadyFree = 0.5;
  PoseDirections& free = alignment.free_directions;
  Vector6d free_too = Vector6d::Zero();
  free_too.head<3>() = direction;
  free_too -= free * (free.transpose() * free_too);
  if (free_too.norm() < kAlreadyFree) return false;
  free_too.normalize();
  free.conservativeResize(6, free.cols() + 1);
  free.rightCols<1>() = free_too;
  alignment.covariance += freeCovariance(free_too);
  return true;
}

}  // namespace

// Little is held for sure along a free direction. It is held all the same where the alignment comes back from both
// sides.
void Localizer::confirmFreeDirections(const SourcePoints& source, AlignmentResult& alignment) {
  constexpr double kWayOff_m = 0.4;
  constexpr double kBack_m = 0.04;
  const Eigen::Isometry3d found = alignment.T_map_source;
  const PoseDirections suspected = alignment.free_directions;
  alignment.free_directions.resize(6, 0);
  for (Eigen::Index k = 0; k < suspected.cols(); ++k) {
    bool comes_back = true;
    for (const double way_m : {-kWayOff_m, kWayOff_m}) {
      if (!comes_back) break;
      Eigen::Isometry3d start = found;
      start.translation() += way_m * suspected.col(k).head<3>();
      start.linear() = rotationFromVector(way_m / kRotationArm_m * suspected.col(k).tail<3>()) * found.linear();
      const AlignmentResult again = aligner_(source, start);
      const double missed_m = inLengths(poseDifference(found, again.T_map_source)).norm();
      comes_back = again.converged() && missed_m < kBack_m;
    }
    if (comes_back) {
      alignment.covariance -= freeCovariance(suspected.col(k));
      continue;
    }
    alignment.free_directions.conservativeResize(6, alignment.free_directions.cols() + 1);
    alignment.free_directions.rightCols<1>() = suspected.col(k);
  }
}

Localizer::Attempt Localizer::attempt(const SourcePoints& source, const Eigen::Isometry3d& T_map_base_start,
                                      const PoseExpectation& expectation) {
  Attempt result;
  result.alignment = aligner_(source, T_map_base_start);
  if (result.alignment.converged()) confirmFreeDirections(source, result.alignment);
  result.T_map_base =
      keptAlongFreeDirections(expectation.T_map_base, result.alignment.T_map_source, result.alignment.free_directions);
  result.acceptance = judge_.judge(result.alignment, result.T_map_base, expectation);
  return result;
}

std::vector<Eigen::Isometry3d> Localizer::rivalsOf(const SourcePoints& source, const Attempt& found,
                                                   const PoseExpectation& expectation) {
  const Eigen::Isometry3d& T_map_found = found.alignment.T_map_source;
  const Eigen::Matrix3d& R_map_base = expectation.T_map_base.linear();
  const TrackState& track = prediction_.state();
  SearchedWay way;
  way.direction = leastHeldDirection(found.alignment.covariance);
  const double speed_mps = (R_map_base * track.velocity_base_mps).dot(way.direction);
  if (std::abs(speed_mps) > kMovingSpeed_mps) way.turn_per_m = R_map_base * track.turn_rate_base_radps / speed_mps;
  const bool is_expected = !expectation.vague && !expectation.unsure && found.alignment.free_directions.cols() == 0 &&
                           !judge_.isSurprising(found.alignment, found.T_map_base, expectation);
  std::vector<Eigen::Isometry3d> starts = rivalStarts(*target_, source, T_map_found, way, expectation.search_radius_m,
                                                      is_expected, options_.alignment.threads);
  if (expectation.any_heading) {
    for (const double turn_deg : {90.0, 180.0, 270.0}) {
      starts.push_back(T_map_found);
      starts.back().linear() = rotationFromVector({0.0, 0.0, radiansFromDegrees(turn_deg)}) * T_map_found.linear();
    }
  }
  std::vector<Eigen::Isometry3d> rivals;
  for (const Eigen::Isometry3d& start : starts) {
    const AlignmentResult rival = aligner_(source, start);
    if (rival.converged()) rivals.push_back(rival.T_map_source);
  }
  return rivals;
}

Localizer::Attempt Localizer::withoutRivals(const SourcePoints& source, const Attempt& found, const Search& search,
                                            const PoseExpectation& expectation) {
  constexpr std::size_t kComparedPoints = 6000;
  const double min_advantage_sigmas = options_.acceptance.min_advantage_sigmas;
  if (!target_ || min_advantage_sigmas == 0.0) return found;
  std::vector<Eigen::Isometry3d> rivals = rivalsOf(source, found, expectation);
  for (const Eigen::Isometry3d& start : search.starts) {
    const AlignmentResult rival = aligner_(source, start);
    if (rival.converged()) rivals.push_back(rival.T_map_source);
  }
  const FitComparison comparison(*target_, source, kComparedPoints);
  Attempt best = found;
  FitComparison::Fits of_best = comparison.fitsAt(best.alignment.T_map_source);
  std::vector<FitComparison::Fits> of_rivals;
  for (const Eigen::Isometry3d& rival : rivals) {
    of_rivals.push_back(comparison.fitsAt(rival));
    if (comparison.advantage(of_best, of_rivals.back()) > -min_advantage_sigmas) continue;
    best = attempt(source, rival, expectation);
    of_best = comparison.fitsAt(best.alignment.T_map_source);
  }
  bool ambiguous = false;
  for (std::size_t i = 0; i < rivals.size(); ++i) {
    ambiguous |=
        isElsewhere(best.alignment, rivals[i]) && comparison.advantage(of_best, of_rivals[i]) < min_advantage_sigmas;
  }
  if (!ambiguous) return best;

  // The scan fits elsewhere as well. That is no harm if it fits where the vehicle is expected along that way.
  if (!judge_.isSurprising(best.alignment, best.T_map_base, expectation) &&
      setFree(leastHeldDirection(found.alignment.covariance), best.alignment)) {
    best.T_map_base =
        keptAlongFreeDirections(expectation.T_map_base, best.alignment.T_map_source, best.alignment.free_directions);
    best.acceptance = judge_.judge(best.alignment, best.T_map_base, expectation);
    if (best.accepted() && comparison.advantage(of_best, comparison.fitsAt(best.T_map_base)) < min_advantage_sigmas) {
      return best;
    }
  }
  best.acceptance = Acceptance::AMBIGUOUS;
  return best;
}

Localizer::Attempt Localizer::fromPrediction(const SourcePoints& source, const PoseExpectation& expectation) {
  const TrackState& track = prediction_.state();
  const Attempt found = attempt(source, expectation.T_map_base, expectation);
  // The motion may have been a wrong one.
  constexpr double kAnotherStart_m = 1.0;
  const double away_m = (track.T_map_base.translation() - expectation.T_map_base.translation()).norm();
  if (found.accepted() || !track.stamp_s || away_m <= kAnotherStart_m) return found;
  const Attempt again = attempt(source, track.T_map_base, expectation);
  return again.accepted() ? again : found;
}

// Aligns from the candidates of a search, the best first, until one is accepted; the others are left to be compared.
Localizer::Attempt Localizer::fromSearch(const SourcePoints& source, const PoseExpectation& expectation,
                                         Search& search) {
  std::optional<SearchRegion> region;
  if (search.extent == SearchExtent::AROUND) region = regionOf(expectation);
  std::vector<PoseCandidate> candidates = global_search_->candidates(source, region, options_.alignment.threads);
  candidates.resize(std::min(candidates.size(), kMostAlignedCandidates));
  search.starts.clear();
  Attempt found;
  for (const PoseCandidate& candidate : candidates) {
    if (candidate.matched_share < kLeastShareOfBest * candidates.front().matched_share) break;
    if (found.accepted()) {
      search.starts.push_back(candidate.T_map_base);
      continue;
    }
    const Attempt next =
        attempt(source, candidate.T_map_base, region ? expectation : judge_.expectAnywhere(candidate.T_map_base));
    if (next.accepted() || &candidate == &candidates.front()) found = next;
    if (!next.accepted() && next.alignment.converged()) search.starts.push_back(next.alignment.T_map_source);
  }
  return found;
}

Localizer::Attempt Localizer::find(const SourcePoints& source, PoseExpectation& expectation, Search& search) {
  const TrackState& track = prediction_.state();
  Attempt found;
  if (track.pose_known) found = fromPrediction(source, expectation);
  const bool is_start = !track.stamp_s || track.status != TrackStatus::TRACKING;
  if (global_search_ && track.pose_known && (!found.accepted() || (is_start && expectation.vague))) {
    search.extent = SearchExtent::AROUND;
    const Attempt other = fromSearch(source, expectation, search);
    if (found.accepted() && other.accepted()) search.starts.push_back(other.alignment.T_map_source);
    if (!found.accepted() && other.accepted()) found = other;
  }
  if (global_search_ && !found.accepted() && track.status == TrackStatus::LOST) {
    search.extent = SearchExtent::EVERYWHERE;
    const Attempt other = fromSearch(source, expectation, search);
    if (other.accepted() || !track.pose_known) {
      found = other;
      expectation = judge_.expectAnywhere(other.T_map_base);
    }
  }
  if (!found.accepted() || !judge_.isDoubtful(found.alignment, found.T_map_base, expectation, track)) return found;
  found = withoutRivals(source, found, search, expectation);
  if (found.accepted()) {
    found.acceptance = judge_.judgeDoubtful(found.alignment, found.T_map_base, expectation, track);
  }
  return found;
}

LocalizationResult Localizer::localize(const ScanView& scan, double stamp_s) {
  const internal::Stopwatch total;
  const internal::HelperSession session(options_.alignment.threads);
  LocalizationResult result;
  result.stamp_s = stamp_s;
  result.T_map_base_predicted = prediction_.predict(stamp_s);
  PoseExpectation expectation = judge_.expect(result.T_map_base_predicted, prediction_.predictedCovariance(stamp_s),
                                              prediction_.state(), stamp_s, options_.prediction.max_turn_rate_radps);
  const SourcePoints& source = preparation_.prepare(scan);
  result.source_points = source.size();
  result.times.segment_ms = preparation_.segmentMilliseconds();
  result.times.filter_ms = preparation_.filterMilliseconds();

  const internal::Stopwatch alignment;
  Search search;
  const Attempt found = find(source, expectation, search);
  result.search = search.extent;
  result.times.align_ms = alignment.milliseconds();

  result.alignment = found.alignment;
  result.correction = correctionOf(result.T_map_base_predicted, found.alignment.T_map_source);
  result.acceptance = found.acceptance;
  if (result.accepted()) {
    result.T_map_base = found.T_map_base;
    result.free_directions = found.alignment.free_directions;
    MeasuredPose pose{found.T_map_base, found.alignment.covariance, found.alignment.free_directions};
    if (std::isfinite(found.alignment.overlap)) pose.overlap = found.alignment.overlap;
    if (search.extent == SearchExtent::EVERYWHERE) {
      result.covariance = prediction_.restart(pose, stamp_s);
    } else {
      pose.learn_velocity = !prediction_.isSurprising(pose, stamp_s);
      result.covariance = prediction_.accept(pose, stamp_s);
    }
  } else {
    result.T_map_base = result.T_map_base_predicted;
    result.covariance = prediction_.predictedCovariance(stamp_s);
    prediction_.reject(stamp_s);
  }
  result.track = prediction_.state();
  result.times.total_ms = total.milliseconds();
  return result;
}

}  // namespace saw_ndt
