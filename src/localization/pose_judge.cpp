#include "saw_ndt/localization/pose_judge.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/localization/motion_prediction.h"

namespace saw_ndt {
namespace {

// A vehicle that brakes as hard as it can (m/s^2).
constexpr double kHardestAcceleration_mps2 = 10.0;

// The squared Mahalanobis distance of six numbers that one pose in a thousand exceeds by chance.
constexpr double kSurprisingSquaredMahalanobis = 22.5;

// How far an error may reach.
constexpr double kSigmas = 3.0;

// A prediction less sure than this does not tell one place of a road from the next (m), nor one heading from another.
constexpr double kVagueSigma_m = 1.0;
constexpr double kVagueSigma_rad = 0.3;

// With this share of the usual overlap a pose is looked at again; with less than the second it is not taken even where
// it is expected. From scan to scan the overlap of right poses changes by a few hundredths.
constexpr double kLessThanUsual = 0.93;
constexpr double kMuchLessThanUsual = 0.7;

// Without a pose for longer, predictions are doubted (s).
constexpr double kLongestGap_s = 0.35;

// In doubt, so far along the road is looked for rivals at least (m).
constexpr double kLeastSearchRadius_m = 5.0;

double largestSigma(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues().maxCoeff()));
}

// The covariance without what is free.
Matrix6d heldCovariance(const AlignmentResult& alignment) {
  Vector6d arm = Vector6d::Ones();
  arm.tail<3>().setConstant(kRotationArm_m);
  const PoseDirections& free = alignment.free_directions;
  const Matrix6d held = Matrix6d::Identity() - free * free.transpose();
  const Matrix6d in_lengths = held * arm.asDiagonal() * alignment.covariance * arm.asDiagonal() * held;
  return arm.cwiseInverse().asDiagonal() * in_lengths * arm.cwiseInverse().asDiagonal();
}

}  // namespace

void AcceptanceOptions::check() const {
  const auto isShare = [](double value) { return value >= 0.0 && value <= 1.0; };
  checkOption(min_likelihood >= 0.0, "min_likelihood", min_likelihood, "0 or more");
  checkOption(isShare(min_overlap), "min_overlap", min_overlap, "between 0 and 1");
  checkOption(isShare(min_overlap_in_doubt), "min_overlap_in_doubt", min_overlap_in_doubt, "between 0 and 1");
  checkOption(isShare(min_usual_overlap_share), "min_usual_overlap_share", min_usual_overlap_share, "between 0 and 1");
  checkOption(min_advantage_sigmas >= 0.0, "min_advantage_sigmas", min_advantage_sigmas, "0 or more");
  checkOption(max_correction_m > 0.0, "max_correction_m", max_correction_m, "positive");
  checkOption(max_correction_deg > 0.0, "max_correction_deg", max_correction_deg, "positive");
  checkOption(max_unknown_speed_mps >= 0.0, "max_unknown_speed_mps", max_unknown_speed_mps, "0 or more");
  checkOption(max_sigma_m > 0.0, "max_sigma_m", max_sigma_m, "positive");
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
  const double since_last_s = track.timeSinceLast(stamp_s).value_or(0.0);
  const double elapsed_s = std::abs(since_last_s);
  const double sigma_m = largestSigma(covariance.topLeftCorner<3, 3>());
  const double sigma_rad = largestSigma(covariance.bottomRightCorner<3, 3>());
  const double way_m = track.velocity_known ? 0.5 * kHardestAcceleration_mps2 * elapsed_s * elapsed_s
                                            : options_.max_unknown_speed_mps * elapsed_s;
  PoseExpectation expectation;
  expectation.T_map_base = T_map_base_predicted;
  expectation.covariance = covariance;
  expectation.max_correction_m = std::max({options_.max_correction_m, way_m, kSigmas * sigma_m});
  expectation.max_correction_deg =
      std::max({options_.max_correction_deg,
                degreesFromRadians(std::max(max_turn_rate_radps * elapsed_s, kSigmas * sigma_rad))});
  // Over a gap, or back in time, it may as well be the stamp that is wrong, and the whole way with it.
  const double predicted_way_m = (T_map_base_predicted.translation() - track.T_map_base.translation()).norm();
  const bool wrong_stamp = since_last_s < 0.0 || since_last_s > kLongestGap_s;
  if (wrong_stamp) expectation.max_correction_m = std::max(expectation.max_correction_m, 1.2 * predicted_way_m);
  const bool anywhere = !track.stamp_s || track.status == TrackStatus::LOST;
  expectation.search_radius_m = anywhere
                                    ? kSigmas * kFreeSigma_m
                                    : std::clamp(std::max(kSigmas * sigma_m, wrong_stamp ? 1.2 * predicted_way_m : 0.0),
                                                 kLeastSearchRadius_m, kSigmas * kFreeSigma_m);
  expectation.vague = anywhere || wrong_stamp || sigma_m > kVagueSigma_m || sigma_rad > kVagueSigma_rad;
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
  if (alignment.free_directions.cols() == 6) return Acceptance::UNDETERMINED;
  if (largestSigma(heldCovariance(alignment).topLeftCorner<3, 3>()) > options_.max_sigma_m) {
    return Acceptance::UNDETERMINED;
  }
  const PoseCorrection correction = correctionOf(expectation.T_map_base, T_map_base);
  if (!(correction.distance_m <= expectation.max_correction_m)) return Acceptance::LARGE_TRANSLATION;
  if (!(degreesFromRadians(correction.angle_rad) <= expectation.max_correction_deg)) return Acceptance::LARGE_ROTATION;
  return Acceptance::ACCEPTED;
}

bool PoseJudge::isSurprising(const AlignmentResult& alignment, const Eigen::Isometry3d& T_map_base,
                             const PoseExpectation& expectation) const {
  const Vector6d surprise = poseDifference(expectation.T_map_base, T_map_base);
  const Matrix6d covariance = expectation.covariance + heldCovariance(alignment);
  return surprise.dot(covariance.ldlt().solve(surprise)) > kSurprisingSquaredMahalanobis;
}

bool PoseJudge::isDoubtful(const AlignmentResult& alignment, const Eigen::Isometry3d& T_map_base,
                           const PoseExpectation& expectation, const TrackState& track) const {
  const bool fits_worse = alignment.overlap < kLessThanUsual * track.usual_overlap.value_or(0.0);
  return expectation.vague || fits_worse || isSurprising(alignment, T_map_base, expectation);
}

Acceptance PoseJudge::judgeDoubtful(const AlignmentResult& alignment, const Eigen::Isometry3d& T_map_base,
                                    const PoseExpectation& expectation, const TrackState& track) const {
  const bool unexpected = expectation.vague || isSurprising(alignment, T_map_base, expectation);
  const double usual_share = unexpected ? options_.min_usual_overlap_share : kMuchLessThanUsual;
  const double least = std::max(unexpected ? options_.min_overlap_in_doubt : options_.min_overlap,
                                usual_share * track.usual_overlap.value_or(0.0));
  return alignment.overlap < least ? Acceptance::LOW_OVERLAP : Acceptance::ACCEPTED;
}

}  // namespace saw_ndt
