#pragma once

#include <Eigen/Geometry>

#include "saw_ndt/common/export.h"
#include "saw_ndt/localization/track_state.h"
#include "saw_ndt/registration/alignment.h"

namespace saw_ndt {

/// When a pose is published and stored (Section III.C of the paper, and more). None depends on the size of voxels;
/// docs/trust.md has the measurements behind the numbers.
struct SAW_NDT_EXPORT AcceptanceOptions {
  double min_likelihood = 0.5;  ///< least Likelihoods::unweighted, which weights do not change
  double min_overlap = 0.3;     ///< least AlignmentResult::overlap, where it is known
  /// The same of a pose in doubt (PoseJudge::isDoubtful()): right ones have 0.6 and more where the map is true, wrong
  /// ones 0.5 and less, but along a road.
  double min_overlap_in_doubt = 0.45;
  /// The same of a pose that was found somewhere in the map, without regard to a prediction: right ones have 0.72 and
  /// more, wrong ones 0.58 and less.
  double min_overlap_anywhere = 0.65;
  /// Least share of the usual overlap of this drive of a pose that is vaguely expected or surprising; of others in
  /// doubt this or 0.7, whichever is less.
  double min_usual_overlap_share = 0.8;
  /// In doubt, other poses along the direction that is held least are tried. One is AMBIGUOUS unless the points that
  /// lie on surfaces of the map at it alone are more than those at any other alone, by so many standard deviations. 0:
  /// none are tried.
  double min_advantage_sigmas = 5.0;
  /// Greatest distance of the pose from the prediction (m), where that is sure. It grows with the time since the last
  /// pose, by what an acceleration of 10 m/s^2 does, and with the uncertainty of the prediction: three standard
  /// deviations are always allowed.
  double max_correction_m = 3.0;
  /// Greatest turn from the prediction (degrees). It grows likewise, by MotionPredictionOptions::max_turn_rate_radps.
  double max_correction_deg = 10.0;
  double max_sigma_m = 0.5;  ///< a pose that is less sure along a direction that is not free tells nothing
  /// Neither does one of which the prediction, which is kept along free directions, is less sure than this.
  double max_free_sigma_m = 300.0;
  double max_free_sigma_deg = 20.0;  ///< the same of its rotation

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// Why a scan was accepted or not.
enum class Acceptance {
  ACCEPTED,
  NOT_CONVERGED,
  LOW_LIKELIHOOD,
  LARGE_TRANSLATION,
  LARGE_ROTATION,
  UNREADABLE,
  LOW_OVERLAP,   ///< too few points lie on surfaces of the map
  UNDETERMINED,  ///< too few points, or nothing that holds a pose
  AMBIGUOUS,     ///< another pose explains the scan as well
};

/// "accepted", "not converged", "low likelihood", "large translation", "large rotation", "unreadable scan",
/// "low overlap", "undetermined", "ambiguous"
SAW_NDT_EXPORT const char* toString(Acceptance acceptance);

/// How far registration moved a pose from its prediction.
struct PoseCorrection {
  double distance_m = 0.0;
  double angle_rad = 0.0;
};
SAW_NDT_EXPORT PoseCorrection correctionOf(const Eigen::Isometry3d& T_map_predicted,
                                           const Eigen::Isometry3d& T_map_aligned);

/// What the motion of the vehicle says of a scan before it is aligned.
struct PoseExpectation {
  Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();
  double max_correction_m = 0.0;
  double max_correction_deg = 0.0;
  double search_radius_m = 0.0;  ///< how far along the road the vehicle may be from there, if all is doubted
  bool unsure = false;           ///< by more than 0.3 m: a pose next to the right one may pass for it
  bool vague = false;            ///< nothing much is expected: there is no pose before, or the prediction is unsure
  bool any_heading = false;      ///< the vehicle may look the other way
  bool anywhere = false;         ///< nothing at all is expected
};

/// Judges the result of an alignment. Immutable, and safe to use from many threads.
class SAW_NDT_EXPORT PoseJudge {
 public:
  /// @throws std::invalid_argument where an option does not hold
  explicit PoseJudge(const AcceptanceOptions& options = {});

  /// The limits of a correction, for a scan at a stamp (s) after a track.
  /// @param max_turn_rate_radps  what the vehicle can turn
  PoseExpectation expect(const Eigen::Isometry3d& T_map_base_predicted, const Matrix6d& covariance,
                         const TrackState& track, double stamp_s, double max_turn_rate_radps) const;

  /// Where nothing is known of the pose but that it was found somewhere in the map.
  PoseExpectation expectAnywhere(const Eigen::Isometry3d& T_map_base) const;

  /// @param alignment   with likelihoods
  /// @param T_map_base  the pose that would be published
  Acceptance judge(const AlignmentResult& alignment, const Eigen::Isometry3d& T_map_base,
                   const PoseExpectation& expectation) const;

  /// Whether a pose is farther from the expected one than their covariances allow.
  bool isSurprising(const AlignmentResult& alignment, const Eigen::Isometry3d& T_map_base,
                    const PoseExpectation& expectation) const;

  /// Whether fewer points lie on the map than usual in this drive, where that is known.
  bool fitsWorse(const AlignmentResult& alignment, const TrackState& track) const;

  /// Whether a pose that judge() accepts needs a second look: it is vaguely expected or surprising, something is free,
  /// or fewer points lie on the map than usual.
  bool isDoubtful(const AlignmentResult& alignment, const Eigen::Isometry3d& T_map_base,
                  const PoseExpectation& expectation, const TrackState& track) const;
  /// Judges one of those by stricter limits.
  Acceptance judgeDoubtful(const AlignmentResult& alignment, const Eigen::Isometry3d& T_map_base,
                           const PoseExpectation& expectation, const TrackState& track) const;

 private:
  AcceptanceOptions options_;
};

}  // namespace saw_ndt
