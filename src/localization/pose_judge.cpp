#include "saw_ndt/localization/pose_judge.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "registration/pose_lengths.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/localization/motion_prediction.h"

namespace saw_ndt {
namespace {

// A vehicle that brakes as hard as it can (m/s^2).
constexpr double kHardestAcceleration_mps2 = 10.0;

// How far an error may reach.
constexpr double kSigmas = 3.0;

// A prediction less sure than this does not tell the right pose from one next to it (m).
constexpr double kUnsureSigma_m = 0.3;

// One less sure than this does not tell one place of a road from the next (m), nor one heading from another.
constexpr double kVagueSigma_m = 1.0;
constexpr double kVagueSigma_rad = 0.3;

// With this share of the usual overlap a pose is looked at again; with less than the second it is not taken even where
// it is expected. From scan to scan the overlap of right poses changes by a few hundredths.
constexpr double kLessThanUsual = 0.93;
constexpr double kMuchLessThanUsual = 0.7;

// In doubt, so far along the road is looked for rivals at least and at most (m).
constexpr double kLeastSearchRadius_m = 5.0;
constexpr double kGreatestSearchRadius_m = 300.0;

// On bare land two positions and the heading are free. Where height, roll or pitch are by more than this share, it is
// not even the ground that is seen.
constexpr double kMostFreeShareOffTheGround = 0.25;

// Where so many directions are free, the others are not held by much: less than the usual overlap is too little.
constexpr Eigen::Index kManyFreeDirections = 2;

double largestSigma(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues().maxCoeff()));
}

// The covariance without what is free.
Matrix6d heldCovariance(const AlignmentResult& alignment) {
  const Matrix6d held = Matrix6d::Identity() - internal::projectorOnto(alignment.free_directions);
  return held * alignment.covariance * held.transpose();
}

}  // namespace

void AcceptanceOptions::check() const {
  const auto isShare = [](double value) { return value >= 0.0 && value <= 1.0; };
  checkOption(min_likelihood >= 0.0, "min_likelihood", min_likelihood, "0 or more");
  checkOption(isShare(min_overlap), "min_overlap", min_overlap, "between 0 and 1");
  checkOption(isShare(min_overlap_in_doubt), "min_overlap_in_doubt", min_overlap_in_doubt, "between 0 and 1");
  checkOption(isShare(min_overlap_anywhere), "min_overlap_anywhere", min_overlap_anywhere, "between 0 and 1");
  checkOption(isShare(min_usual_overlap_share), "min_usual_overlap_share", min_usual_overlap_share, "between 0 and 1");
  checkOption(min_advantage_sigmas >= 0.0, "min_advantage_sigmas", min_advantage_sigmas, "0 or more");
  checkOption(max_correction_m > 0.0, "max_correction_m", max_correction_m, "positive");
  checkOption(max_correction_deg > 0.0, "max_correction_deg", max_correction_deg, "positive");
  checkOption(max_sigma_m > 0.0, "max_sigma_m", max_sigma_m, "positive");
  checkOption(max_free_sigma_m > 0.0, "max_free_sigma_m", max_free_sigma_m, "positive");
  checkOption(max_free_sigma_deg > 0.0, "max_free_sigma_deg", max_free_sigma_deg, "positive");
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
    case Acceptance::UNREADABLE:
      return "unreadable scan";
    case Acceptance::LOW_OVERLAP:
      return "low overlap";
    case Acceptance::UNDETERMINED:
      return "undetermined";
    case Acceptance::AMBIGUOUS:
      return "ambiguous";
  }
  return "unknown";
}

PoseCorrection correctionOf(const Eigen::Isometry3d& T_map_predicted, const Eigen::Isometry3d& T_map_aligned) {
  const Eigen::Isometry3d T_predicted_aligned = T_map_predicted.inverse() * T_map_aligned;
  return {T_predicted_aligned.translation().norm(), rotationAngle(T_predicted_aligned.linear())};
}

PoseJudge::PoseJudge(const AcceptanceOptions& options) : options_(options) { options_.check(); }

PoseExpectation PoseJudge::expect(const Eigen::Isometry3d& T_map_base_predicted, const Matrix6d& covariance,
                                  const TrackState& track, double stamp_s, double max_turn_rate_radps) const {
  const double elapsed_s = std::abs(track.timeSinceLast(stamp_s).value_or(0.0));
  const double sigma_m = largestSigma(covariance.topLeftCorner<3, 3>());
  const double sigma_rad = largestSigma(covariance.bottomRightCorner<3, 3>());
  const double way_m = 0.5 * kHardestAcceleration_mps2 * elapsed_s * elapsed_s;
  PoseExpectation expectation;
  expectation.T_map_base = T_map_base_predicted;
  expectation.covariance = covariance;
  expectation.max_correction_m = std::max({options_.max_correction_m, way_m, kSigmas * sigma_m});
  expectation.max_correction_deg =
      std::max({options_.max_correction_deg,
                degreesFromRadians(std::max(max_turn_rate_radps * elapsed_s, kSigmas * sigma_rad))});
  const bool anywhere = !track.stamp_s || track.isLost();
  expectation.search_radius_m =
      std::clamp(kSigmas * sigma_m, anywhere ? kSigmas * kFreeSigma_m : kLeastSearchRadius_m, kGreatestSearchRadius_m);
  expectation.unsure = sigma_m > kUnsureSigma_m;
  expectation.any_heading = kSigmas * sigma_rad > 0.5 * kPi;
  expectation.vague = anywhere || sigma_m > kVagueSigma_m || sigma_rad > kVagueSigma_rad;
  return expectation;
}

PoseExpectation PoseJudge::expectAnywhere(const Eigen::Isometry3d& T_map_base) const {
  PoseExpectation expectation;
  expectation.T_map_base = T_map_base;
  // What is free is not known at all.
  expectation.covariance = anywhereCovariance();
  expectation.max_correction_m = kSigmas * largestSigma(expectation.covariance.topLeftCorner<3, 3>());
  expectation.max_correction_deg = 180.0;
  expectation.search_radius_m = kLeastSearchRadius_m;  // the search has looked everywhere
  expectation.unsure = true;
  expectation.vague = true;
  expectation.anywhere = true;
  return expectation;
}

Acceptance PoseJudge::judge(const AlignmentResult& alignment, const Eigen::Isometry3d& T_map_base,
                            const PoseExpectation& expectation) const {
  if (alignment.status == AlignmentStatus::UNDETERMINED) {
    return alignment.overlap < options_.min_overlap ? Acceptance::LOW_OVERLAP : Acceptance::UNDETERMINED;
  }
  if (!alignment.converged()) return Acceptance::NOT_CONVERGED;
  if (!(alignment.likelihoods.unweighted >= options_.min_likelihood)) return Acceptance::LOW_LIKELIHOOD;
  if (alignment.overlap < options_.min_overlap) return Acceptance::LOW_OVERLAP;
  if (alignment.free_directions.middleRows<3>(2).squaredNorm() > kMostFreeShareOffTheGround) {
    return Acceptance::UNDETERMINED;
  }
  const Matrix6d free = internal::projectorOnto(alignment.free_directions);
  const Matrix6d kept = free * expectation.covariance * free.transpose();
  if (largestSigma(kept.topLeftCorner<3, 3>()) > options_.max_free_sigma_m ||
      degreesFromRadians(largestSigma(kept.bottomRightCorner<3, 3>())) > options_.max_free_sigma_deg) {
    return Acceptance::UNDETERMINED;
  }
  if (largestSigma(heldCovariance(alignment).topLeftCorner<3, 3>()) > options_.max_sigma_m) {
    return Acceptance::UNDETERMINED;
  }
  const PoseCorrection correction = correctionOf(expectation.T_map_base, T_map_base);
  if (!(correction.distance_m <= expectation.max_correction_m)) return Acceptance::LARGE_TRANSLATION;
  if (!(degreesFromRadians(correction.angle_rad) <= expectation.max_correction_deg)) return Acceptance::LARGE_ROTATION;
  return Acceptance::ACCEPTED;
}

bool PoseJudge::fitsWorse(const AlignmentResult& alignment, const TrackState& track) const {
  return alignment.overlap < kLessThanUsual * track.usual_overlap.value_or(0.0);
}

bool PoseJudge::isSurprising(const AlignmentResult& alignment, const Eigen::Isometry3d& T_map_base,
                             const PoseExpectation& expectation) const {
  return isUnlikely(poseDifference(expectation.T_map_base, T_map_base),
                    expectation.covariance + heldCovariance(alignment));
}

bool PoseJudge::isDoubtful(const AlignmentResult& alignment, const Eigen::Isometry3d& T_map_base,
                           const PoseExpectation& expectation, const TrackState& track) const {
  return expectation.vague || expectation.unsure || alignment.free_directions.cols() > 0 ||
         fitsWorse(alignment, track) || isSurprising(alignment, T_map_base, expectation);
}

Acceptance PoseJudge::judgeDoubtful(const AlignmentResult& alignment, const Eigen::Isometry3d& T_map_base,
                                    const PoseExpectation& expectation, const TrackState& track) const {
  if (fitsWorse(alignment, track) && alignment.free_directions.cols() >= kManyFreeDirections) {
    return Acceptance::UNDETERMINED;
  }
  const bool unexpected = expectation.vague || isSurprising(alignment, T_map_base, expectation);
  const double usual_share = std::min(options_.min_usual_overlap_share, unexpected ? 1.0 : kMuchLessThanUsual);
  const double least_in_doubt = unexpected ? options_.min_overlap_in_doubt : options_.min_overlap;
  const double least = std::max(expectation.anywhere ? options_.min_overlap_anywhere : least_in_doubt,
                                usual_share * track.usual_overlap.value_or(0.0));
  return alignment.overlap < least ? Acceptance::LOW_OVERLAP : Acceptance::ACCEPTED;
}

}  // namespace saw_ndt
