#pragma once

#include <Eigen/Geometry>

#include "saw_ndt/common/export.h"
#include "saw_ndt/localization/track_state.h"
#include "saw_ndt/registration/alignment.h"

namespace saw_ndt {

/// When a pose is published and stored (Section III.C of the paper).
struct SAW_NDT_EXPORT AcceptanceOptions {
  double min_likelihood = 0.8;       ///< least Likelihoods::unweighted, which weights do not change
  double max_correction_m = 3.0;     ///< greatest distance of the pose from the prediction (m)
  double max_correction_deg = 10.0;  ///< greatest turn from the prediction (degrees)
  /// Before a velocity is known the vehicle may have moved this fast since the last pose (m/s).
  double max_unknown_speed_mps = 40.0;

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// Why a scan was accepted or not.
enum class Acceptance { ACCEPTED, NOT_CONVERGED, LOW_LIKELIHOOD, LARGE_TRANSLATION, LARGE_ROTATION, UNREADABLE };

/// "accepted", "not converged", "low likelihood", "large translation", "large rotation", "unreadable scan"
SAW_NDT_EXPORT const char* toString(Acceptance acceptance);

/// How far registration moved a pose from its prediction.
struct PoseCorrection {
  double distance_m = 0.0;
  double angle_rad = 0.0;
};
SAW_NDT_EXPORT PoseCorrection correctionOf(const Eigen::Isometry3d& T_map_predicted,
                                           const Eigen::Isometry3d& T_map_aligned);

/// Judges the result of an alignment.
class SAW_NDT_EXPORT PoseJudge {
 public:
  /// @throws std::invalid_argument where an option does not hold
  explicit PoseJudge(const AcceptanceOptions& options = {});

  /// @param alignment   with likelihoods
  /// @param correction  from the prediction
  /// @param track       before the scan
  /// @param stamp_s     of the scan
  Acceptance judge(const AlignmentResult& alignment, const PoseCorrection& correction, const TrackState& track,
                   double stamp_s) const;

 private:
  AcceptanceOptions options_;
};

}  // namespace saw_ndt
