#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "localization/source_voxel_filter.h"
#include "registration/likelihoods.h"
#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/localization/localization_method.h"
#include "saw_ndt/localization/motion_prediction.h"
#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/registration/ndt_aligner.h"
#include "saw_ndt/segmentation/scan_segmenter.h"

namespace saw_ndt {

/// When a result is published and stored (Section III.C of the paper).
struct AcceptanceOptions {
  double min_likelihood = 0.8;       ///< least Likelihoods::unweighted, which weights do not change
  double max_correction_m = 3.0;     ///< greatest distance of the result from the prediction (m)
  double max_correction_deg = 10.0;  ///< greatest turn from the prediction (degrees)
  /// Before a velocity is known the vehicle may have moved this fast since the last pose (m/s).
  double max_unknown_speed_mps = 40.0;

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

struct LocalizerOptions {
  LocalizationMethod method = LocalizationMethod::named("weighted");
  SegmentationOptions segmentation;
  double source_voxel_size_m = 0.2;                                ///< see SourceVoxelFilter
  Eigen::Isometry3d T_base_lidar = Eigen::Isometry3d::Identity();  ///< mounting of the LiDAR on the vehicle
  MotionPredictionOptions prediction;
  AlignmentOptions alignment;  ///< use_weights, mismatch_penalty and outlier_ratio are the method's
  AcceptanceOptions acceptance;

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// Why a scan was accepted or not.
enum class Acceptance { ACCEPTED, NOT_CONVERGED, LOW_LIKELIHOOD, LARGE_TRANSLATION, LARGE_ROTATION };

/// "accepted", "not converged", "low likelihood", "large translation", "large rotation"
const char* toString(Acceptance acceptance);

/// Wall-clock time of the stages of one scan, in milliseconds.
struct StageTimes {
  double segment_ms = 0.0;  ///< labels of the scan
  double filter_ms = 0.0;   ///< ground subsampling, base frame, source voxels
  double align_ms = 0.0;    ///< registration
  double total_ms = 0.0;    ///< from the scan in memory to the pose, likelihoods and acceptance included
};

struct LocalizationResult {
  double stamp_s = 0.0;
  Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();  ///< the prediction where the scan was rejected
  Acceptance acceptance = Acceptance::NOT_CONVERGED;
  Eigen::Isometry3d T_map_base_predicted = Eigen::Isometry3d::Identity();
  AlignmentResult alignment;
  Likelihoods likelihoods;
  /// Inverse of the curvature of the score by (translation, rotation), see NdtDerivatives: which directions are well
  /// held and which are not. Relative, not calibrated; zero where the scan was rejected or the curvature is singular.
  Matrix6d covariance = Matrix6d::Zero();
  double correction_m = 0.0;    ///< distance of the registration's result from the prediction
  double correction_rad = 0.0;  ///< turn of the registration's result from the prediction
  std::size_t source_points = 0;
  StageTimes times;

  bool accepted() const { return acceptance == Acceptance::ACCEPTED; }
};

/// Completes a result of which prediction, alignment and likelihoods are known: judges it by the limits and sets
/// corrections, acceptance and pose. An accepted pose goes into `prediction`.
void concludeLocalization(LocalizationResult& result, const AcceptanceOptions& limits, MotionPrediction& prediction);

/// Follows a vehicle through a map, one call a scan: Algorithm 1 of the paper. Scratch memory is kept from scan to
/// scan.
class Localizer {
 public:
  /// @param target  made with options.method.voxels
  /// @throws std::invalid_argument where an option does not hold, the target was made with another weighting, or has no
  ///         labels while the method segments
  Localizer(NdtTarget target, const LocalizerOptions& options);
  /// Makes the target of a map with options.method.voxels.
  Localizer(const WeightedVoxelMap& map, const LocalizerOptions& options);

  /// Where the vehicle is at the first scan, or after it was lost. @throws std::invalid_argument unless it is finite
  void setInitialPose(const Eigen::Isometry3d& T_map_base) { prediction_.reset(T_map_base); }

  /// @param scan     in the LiDAR frame
  /// @param stamp_s  time of the scan; stamps should grow
  /// @throws std::invalid_argument where the stamp is not finite
  LocalizationResult localize(const ScanView& scan, double stamp_s);

  const LocalizerOptions& options() const { return options_; }

 private:
  const SourcePoints& makeSource(const ScanView& scan, StageTimes& times);

  NdtTarget target_;
  LocalizerOptions options_;
  ScanSegmenter segmenter_;
  std::vector<StructuralLabel> labels_;
  SourceVoxelFilter filter_;
  MotionPrediction prediction_;
  NdtAligner aligner_;
};

}  // namespace saw_ndt
