#include "saw_ndt/localization/pose_judge.h"

#include <algorithm>

#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {

void AcceptanceOptions::check() const {
  checkOption(min_likelihood >= 0.0, "min_likelihood", min_likelihood, "0 or more");
  checkOption(max_correction_m > 0.0, "max_correction_m", max_correction_m, "positive");
  checkOption(max_correction_deg > 0.0, "max_correction_deg", max_correction_deg, "positive");
  checkOption(max_unknown_speed_mps >= 0.0, "max_unknown_speed_mps", max_unknown_speed_mps, "0 or more");
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
  }
  return "unknown";
}

PoseCorrection correctionOf(const Eigen::Isometry3d& T_map_predicted, const Eigen::Isometry3d& T_map_aligned) {
  const Eigen::Isometry3d T_predicted_aligned = T_map_predicted.inverse() * T_map_aligned;
  return {T_predicted_aligned.translation().norm(), rotationAngle(T_predicted_aligned.linear())};
}

PoseJudge::PoseJudge(const AcceptanceOptions& options) : options_(options) { options_.check(); }

Acceptance PoseJudge::judge(const AlignmentResult& alignment, const PoseCorrection& correction, const TrackState& track,
                            double stamp_s) const {
  double max_correction_m = options_.max_correction_m;
  if (!track.velocity_known) {
    const double elapsed_s = std::max(0.0, track.timeSinceLast(stamp_s).value_or(0.0));
    max_correction_m = std::max(max_correction_m, options_.max_unknown_speed_mps * elapsed_s);
  }
  if (!alignment.converged()) return Acceptance::NOT_CONVERGED;
  if (!(alignment.likelihoods.unweighted >= options_.min_likelihood)) return Acceptance::LOW_LIKELIHOOD;
  if (!(correction.distance_m <= max_correction_m)) return Acceptance::LARGE_TRANSLATION;
  if (!(degreesFromRadians(correction.angle_rad) <= options_.max_correction_deg)) return Acceptance::LARGE_ROTATION;
  return Acceptance::ACCEPTED;
}

}  // namespace saw_ndt
