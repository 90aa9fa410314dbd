#include "localization/pose_finder.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "localization/rival_poses.h"
#include "registration/pose_lengths.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt::internal {
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

double horizontalSigma(const Matrix6d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> position(covariance.topLeftCorner<2, 2>(),
                                                                Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, position.eigenvalues().maxCoeff()));
}

// As far around a pose as it is uncertain.
SearchRegion regionOf(const PoseExpectation& expectation) {
  const double sigma_m = horizontalSigma(expectation.covariance);
  const double sigma_deg = degreesFromRadians(std::sqrt(expectation.covariance(5, 5)));
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

PoseFinder::PoseFinder(SourceAligner aligner, const LocalizerOptions& options)
    : aligner_(std::move(aligner)),
      judge_(options.acceptance),
      min_advantage_sigmas_(options.acceptance.min_advantage_sigmas),
      threads_(options.alignment.threads) {}

PoseFinder::PoseFinder(const TiledTarget& target, const LocalizerOptions& options)
    : PoseFinder(SourceAligner(), options) {
  alignment_ = options.alignment;
  target_ = target;
  if (!options.search) return;
  if (target.map()) {
    search_.emplace(*target.map(), options.global_search);
  } else {
    search_.emplace(target_->at(Eigen::Vector3d::Zero(), 0.0), options.global_search);
  }
}

AlignmentResult PoseFinder::align(const SourcePoints& source, const Eigen::Isometry3d& T_map_base_start) {
  if (aligner_) return aligner_(source, T_map_base_start);
  return ndt_aligner_.align(targetAt(T_map_base_start), source, T_map_base_start, alignment_);
}

// Little is held for sure along a free direction. It is held all the same where the alignment comes back from both
// sides.
void PoseFinder::confirmFreeDirections(const SourcePoints& source, AlignmentResult& alignment) {
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
      const AlignmentResult again = align(source, start);
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

PoseAttempt PoseFinder::attempt(const SourcePoints& source, const Eigen::Isometry3d& T_map_base_start,
                                const PoseExpectation& expectation) {
  PoseAttempt result;
  result.alignment = align(source, T_map_base_start);
  if (result.alignment.converged()) confirmFreeDirections(source, result.alignment);
  result.T_map_base =
      keptAlongFreeDirections(expectation.T_map_base, result.alignment.T_map_source, result.alignment.free_directions);
  result.acceptance = judge_.judge(result.alignment, result.T_map_base, expectation);
  return result;
}

std::vector<Eigen::Isometry3d> PoseFinder::rivalsOf(const SourcePoints& source, const PoseAttempt& found,
                                                    const std::vector<Eigen::Isometry3d>& other_starts,
                                                    const PoseExpectation& expectation, const TrackState& track) {
  const Eigen::Isometry3d& T_map_found = found.alignment.T_map_source;
  const Eigen::Matrix3d& R_map_base = expectation.T_map_base.linear();
  SearchedWay way;
  way.direction = leastHeldDirection(found.alignment.covariance);
  const double speed_mps = (R_map_base * track.velocity_base_mps).dot(way.direction);
  if (std::abs(speed_mps) > kMovingSpeed_mps) way.turn_per_m = R_map_base * track.turn_rate_base_radps / speed_mps;
  const bool is_expected = !expectation.vague && !expectation.unsure && found.alignment.free_directions.cols() == 0 &&
                           !judge_.isSurprising(found.alignment, found.T_map_base, expectation);
  std::vector<Eigen::Isometry3d> starts =
      rivalStarts(targetAt(T_map_found, expectation.search_radius_m), source, T_map_found, way,
                  expectation.search_radius_m, is_expected, threads_);
  if (expectation.any_heading) {
    for (const double turn_deg : {90.0, 180.0, 270.0}) {
      starts.push_back(T_map_found);
      starts.back().linear() = rotationFromVector({0.0, 0.0, radiansFromDegrees(turn_deg)}) * T_map_found.linear();
    }
  }
  starts.insert(starts.end(), other_starts.begin(), other_starts.end());
  std::vector<Eigen::Isometry3d> rivals;
  for (const Eigen::Isometry3d& start : starts) {
    const AlignmentResult rival = align(source, start);
    if (rival.converged()) rivals.push_back(rival.T_map_source);
  }
  return rivals;
}

PoseAttempt PoseFinder::withoutRivals(const SourcePoints& source, const PoseAttempt& found,
                                      const std::vector<Eigen::Isometry3d>& other_starts,
                                      const PoseExpectation& expectation, const TrackState& track) {
  constexpr std::size_t kComparedPoints = 6000;
  if (!target_ || min_advantage_sigmas_ == 0.0) return found;
  const std::vector<Eigen::Isometry3d> rivals = rivalsOf(source, found, other_starts, expectation, track);
  double furthest_m = 0.0;
  for (const Eigen::Isometry3d& rival : rivals) {
    furthest_m = std::max(furthest_m, (rival.translation() - found.alignment.T_map_source.translation()).norm());
  }
  const FitComparison comparison(targetAt(found.alignment.T_map_source, furthest_m), source, kComparedPoints);
  PoseAttempt best = found;
  FitComparison::Fits of_best = comparison.fitsAt(best.alignment.T_map_source);
  std::vector<FitComparison::Fits> of_rivals;
  for (const Eigen::Isometry3d& rival : rivals) {
    of_rivals.push_back(comparison.fitsAt(rival));
    if (comparison.advantage(of_best, of_rivals.back()) > -min_advantage_sigmas_) continue;
    best = attempt(source, rival, expectation);
    of_best = comparison.fitsAt(best.alignment.T_map_source);
  }
  bool ambiguous = false;
  for (std::size_t i = 0; i < rivals.size(); ++i) {
    ambiguous |=
        isElsewhere(best.alignment, rivals[i]) && comparison.advantage(of_best, of_rivals[i]) < min_advantage_sigmas_;
  }
  if (!ambiguous) return best;

  // The scan fits elsewhere as well. That is no harm if it fits where the vehicle is expected along that way.
  if (!judge_.isSurprising(best.alignment, best.T_map_base, expectation) &&
      setFree(leastHeldDirection(found.alignment.covariance), best.alignment)) {
    best.T_map_base =
        keptAlongFreeDirections(expectation.T_map_base, best.alignment.T_map_source, best.alignment.free_directions);
    best.acceptance = judge_.judge(best.alignment, best.T_map_base, expectation);
    if (best.accepted() && comparison.advantage(of_best, comparison.fitsAt(best.T_map_base)) < min_advantage_sigmas_) {
      return best;
    }
  }
  best.acceptance = Acceptance::AMBIGUOUS;
  return best;
}

PoseAttempt PoseFinder::settled(const SourcePoints& source, const PoseAttempt& found,
                                const std::vector<Eigen::Isometry3d>& other_starts, const PoseExpectation& expectation,
                                const TrackState& track) {
  if (!found.accepted() || !judge_.isDoubtful(found.alignment, found.T_map_base, expectation, track)) return found;
  PoseAttempt best = withoutRivals(source, found, other_starts, expectation, track);
  if (best.accepted()) {
    best.acceptance = judge_.judgeDoubtful(best.alignment, best.T_map_base, expectation, track);
  }
  return best;
}

PoseAttempt PoseFinder::fromPrediction(const SourcePoints& source, const PoseExpectation& expectation,
                                       const TrackState& track) {
  const PoseAttempt found = attempt(source, expectation.T_map_base, expectation);
  // The motion may have been a wrong one.
  constexpr double kAnotherStart_m = 1.0;
  const double away_m = (track.T_map_base.translation() - expectation.T_map_base.translation()).norm();
  if (found.accepted() || !track.stamp_s || away_m <= kAnotherStart_m) return found;
  const PoseAttempt again = attempt(source, track.T_map_base, expectation);
  return again.accepted() ? again : found;
}

std::vector<Eigen::Isometry3d> PoseFinder::searchedStarts(const SourcePoints& source,
                                                          const std::optional<SearchRegion>& region) const {
  std::vector<Eigen::Isometry3d> starts;
  const std::vector<PoseCandidate> candidates = search_->candidates(source, region, threads_);
  for (const PoseCandidate& candidate : candidates) {
    const bool is_worse = candidate.matched_share < kLeastShareOfBest * candidates.front().matched_share;
    if (is_worse || starts.size() == kMostAlignedCandidates) break;
    starts.push_back(candidate.T_map_base);
  }
  return starts;
}

PoseAttempt PoseFinder::fromStarts(const SourcePoints& source, const std::vector<Eigen::Isometry3d>& starts,
                                   const PoseExpectation* expectation, const TrackState& track) {
  PoseAttempt found;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const PoseExpectation expected = expectation != nullptr ? *expectation : judge_.expectAnywhere(starts[i]);
    const PoseAttempt next = attempt(source, starts[i], expected);
    if (i == 0) found = next;
    if (!next.accepted()) continue;
    std::vector<Eigen::Isometry3d> others = starts;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    return settled(source, next, others, expected, track);
  }
  return found;
}

bool PoseFinder::isWorthSearching(const PoseAttempt& found, const TrackState& track) const {
  if (!search_ || found.accepted()) return false;
  const bool fits = found.alignment.converged() && track.usual_overlap && !judge_.fitsWorse(found.alignment, track);
  return !(fits && found.acceptance == Acceptance::UNDETERMINED);
}

bool PoseFinder::isInReach(const Matrix6d& covariance) {
  return kRegion_sigmas * horizontalSigma(covariance) <= kGreatestRegion_m;
}

PoseAttempt PoseFinder::find(const SourcePoints& source, const PoseExpectation& expectation, const TrackState& track) {
  PoseAttempt found;
  if (!isInReach(expectation.covariance)) return found;
  const bool is_start = !track.stamp_s || track.status != TrackStatus::TRACKING;
  std::optional<std::vector<Eigen::Isometry3d>> starts;
  found = fromPrediction(source, expectation, track);
  if (search_ && found.accepted() && is_start && expectation.vague) {
    starts = searchedStarts(source, regionOf(expectation));
  }
  found = settled(source, found, starts.value_or(std::vector<Eigen::Isometry3d>()), expectation, track);
  if (isWorthSearching(found, track) && found.acceptance != Acceptance::AMBIGUOUS) {
    if (!starts) starts = searchedStarts(source, regionOf(expectation));
    const PoseAttempt other = fromStarts(source, *starts, &expectation, track);
    if (other.accepted()) found = other;
  }
  if (starts) found.search = SearchExtent::AROUND;
  return found;
}

PoseAttempt PoseFinder::findAnywhere(const SourcePoints& source, const TrackState& track) {
  PoseAttempt found = fromStarts(source, searchedStarts(source, std::nullopt), nullptr, track);
  found.search = SearchExtent::EVERYWHERE;
  return found;
}

}  // namespace saw_ndt::internal
