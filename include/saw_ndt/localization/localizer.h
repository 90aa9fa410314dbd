#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/localization/global_search.h"
#include "saw_ndt/localization/localization_method.h"
#include "saw_ndt/localization/motion_prediction.h"
#include "saw_ndt/localization/pose_judge.h"
#include "saw_ndt/localization/scan_preparation.h"
#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/map/tiled_target.h"
#include "saw_ndt/map/weighted_voxel_map.h"
#include "saw_ndt/registration/ndt_aligner.h"

namespace saw_ndt {

namespace internal {
class PoseFinder;
struct PoseAttempt;
struct MotionPrior;
struct RefinedMotion;
struct ScanMotion;
}  // namespace internal

struct SAW_NDT_EXPORT LocalizerOptions {
  LocalizationMethod method = LocalizationMethod::named("weighted");
  SegmentationOptions segmentation;
  double source_voxel_size_m = 0.2;  ///< edge of the voxels that thin a scan; 0 keeps every point
  Eigen::Isometry3d T_base_lidar = Eigen::Isometry3d::Identity();  ///< mounting of the LiDAR on the vehicle
  /// Where scans are skewed by the motion of the LiDAR: how points are told when they were measured. They are
  /// registered as seen at the stamp, by the motion of ScanPriors where that is given, else by the predicted one, and
  /// again by that with which they fit the map best, if it moves points by a centimetre more. Where no motion is known
  /// yet, speeds straight on are tried out. With an aligner of one's own, the predicted motion is all that is taken.
  MotionCompensation motion_compensation = MotionCompensation::OFF;
  double scan_period_s = 0.0;  ///< how long a turn of the LiDAR takes, where azimuths tell times; 0: from the stamps
  MotionPredictionOptions prediction;
  AlignmentOptions alignment;  ///< what LocalizationMethod has as well is the method's
  AcceptanceOptions acceptance;
  bool search = true;                 ///< look for a pose that has been lost, and at the start around the initial one
  GlobalSearchOptions global_search;  ///< how
  /// How long a scan may take while all of the map is searched (ms); infinite: until that is done. A search that takes
  /// longer goes on in a thread of its own while further scans come, and what it finds is where the vehicle was when it
  /// began. Results then depend on how fast the machine is.
  double search_budget_ms = std::numeric_limits<double>::infinity();
  TiledTargetOptions tiles;  ///< where the map is a LocalizationMap: which of its tiles are in memory
  /// Go on where the labels of the map were made by other segmentation options, such as those of another sensor.
  bool allow_other_segmentation = false;

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// Wall-clock time of the stages of one scan, in milliseconds.
struct StageTimes {
  double segment_ms = 0.0;  ///< labels of the scan
  double filter_ms = 0.0;   ///< ground subsampling, base frame, source voxels
  double align_ms = 0.0;    ///< search and registration
  double total_ms = 0.0;    ///< from the scan in memory to the pose, likelihoods and acceptance included
};

/// Where a pose was looked for, beside the prediction.
enum class SearchExtent {
  NONE,
  AROUND,      ///< as far from the prediction as that is uncertain
  EVERYWHERE,  ///< in all of the map
};

/// "", "around", "everywhere"
SAW_NDT_EXPORT const char* toString(SearchExtent extent);

struct LocalizationResult {
  double stamp_s = 0.0;
  Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();  ///< the prediction where the scan was rejected
  Acceptance acceptance = Acceptance::NOT_CONVERGED;
  Eigen::Isometry3d T_map_base_predicted = Eigen::Isometry3d::Identity();
  /// With likelihoods. T_map_base is its pose, but for free_directions, along which it is the predicted one.
  AlignmentResult alignment;
  /// Of T_map_base, by (translation, rotation) in the axes of the map, about the base's origin: that of the alignment;
  /// along free directions, and where the scan was rejected, that of the prediction. Errors of successive scans are
  /// alike, since they are the map's: a filter that fuses poses must not take them for independent (docs/trust.md).
  Matrix6d covariance = Matrix6d::Zero();
  /// Along which the scan does not hold the pose, as AlignmentResult::free_directions; none where it was rejected.
  PoseDirections free_directions = PoseDirections(6, 0);
  /// The points told when they were measured, and what the motion of the LiDAR does to them was taken out.
  bool motion_compensated = false;
  PoseCorrection correction;  ///< of the prediction by registration
  SearchExtent search = SearchExtent::NONE;
  std::size_t source_points = 0;
  StageTimes times;
  TrackState track;  ///< after this scan

  bool accepted() const { return acceptance == Acceptance::ACCEPTED; }
};

/// Registers a source, in the base's frame, from a predicted pose; fills AlignmentResult::likelihoods.
using SourceAligner =
    std::function<AlignmentResult(const SourcePoints& source, const Eigen::Isometry3d& T_map_base_predicted)>;

/// Follows a vehicle through a map, one call a scan: Algorithm 1 of the paper. It prepares the scan (ScanPreparation),
/// predicts its pose (MotionPrediction), aligns it and judges the result (PoseJudge). Odometry, where it is given,
/// takes the place of a constant velocity; a measured position pulls on the pose by its covariance, which moves what
/// the scan holds by next to nothing, and tells where to search. A scan that is rejected is tried again from the last
/// pose, then from where a GlobalSearch finds it around the prediction and, once the vehicle is lost, everywhere; one
/// in doubt is compared with rival poses. Scratch memory is kept from scan to scan, but for scans in doubt. One object
/// for each vehicle, not to be shared by threads; the map may be.
class SAW_NDT_EXPORT Localizer {
 public:
  /// Makes its own target of a map.
  /// @throws std::invalid_argument where an option does not hold, the map has no labels while the method segments, or
  /// its
  ///         labels were made by other segmentation options than these and allow_other_segmentation is not set
  Localizer(const WeightedVoxelMap& map, const LocalizerOptions& options);
  /// Makes it of a map file, which takes less memory; of a LocalizationMap it holds the tiles around the vehicle alone.
  /// @throws Error where it is missing or damaged
  Localizer(const std::string& map_file, const LocalizerOptions& options);
  /// Shares a target with others.
  /// @param target  made with options.method.voxels: std::invalid_argument where it was not
  Localizer(const NdtTarget& target, const LocalizerOptions& options);
  /// Takes tiles of a map as the vehicle moves, by options of their own. Poses are those in the whole of that map.
  /// localize() throws Error where a tile is damaged
  Localizer(const TiledTarget& target, const LocalizerOptions& options);
  /// With an aligner of one's own.
  /// @throws std::invalid_argument where an option does not hold
  Localizer(SourceAligner aligner, const LocalizerOptions& options);
  ~Localizer();
  Localizer(Localizer&& other) noexcept;
  Localizer& operator=(Localizer&& other) noexcept;

  /// Where the vehicle is at the first scan, or after it was lost.
  /// @throws std::invalid_argument unless it is a finite rigid transform
  void setInitialPose(const Eigen::Isometry3d& T_map_base);
  /// Nobody knows where the vehicle is at the first scan: it is looked for everywhere.
  /// @throws std::logic_error where the localizer has no target of this library, or options().search is false
  void setUnknownPose();

  /// @param scan     in the LiDAR frame
  /// @param stamp_s  time of the scan; stamps should grow
  /// @param priors   what other sensors say of the pose of this scan
  /// @throws std::logic_error before setInitialPose() or setUnknownPose(), std::invalid_argument where the stamp or a
  ///         prior is not finite, has a negative variance, or is a position 1e9 m away
  LocalizationResult localize(const ScanView& scan, double stamp_s, const ScanPriors& priors = {});

  const LocalizerOptions& options() const { return options_; }
  /// What is known of the vehicle after the last scan.
  const TrackState& track() const { return prediction_.state(); }
  /// What became of loading tiles of the map so far; null with an aligner of one's own.
  const TileLoads* tileLoads() const;

 private:
  LocalizerOptions options_;
  ScanPreparation preparation_;
  MotionPrediction prediction_;
  UncertainPose predictedPose(double stamp_s, const std::optional<MeasuredPosition>& position,
                              bool& without_track) const;
  PoseExpectation expectation(const UncertainPose& predicted, double stamp_s) const;
  internal::PoseAttempt find(const SourcePoints& source, const UncertainPose& predicted, double stamp_s);
  UncertainPose accept(const internal::PoseAttempt& found, double stamp_s,
                       const std::optional<MeasuredPosition>& position, bool without_track);

  internal::PoseAttempt searchEverywhere(const SourcePoints& source, double stamp_s, double elapsed_ms);

  struct ScanInWork;
  struct OngoingSearch;
  struct Moving;

  static std::unique_ptr<Moving> makeMoving(const LocalizerOptions& options, bool refines);
  internal::PoseAttempt locate(const SourcePoints& source, ScanInWork& scan);
  internal::PoseAttempt locateMoving(const SourcePoints& measured, const ScanPriors& priors, ScanInWork& scan);
  std::optional<internal::RefinedMotion> refinedAtAnySpeed(const Eigen::Isometry3d& T_map_base_start,
                                                           const internal::MotionPrior& prior);
  internal::PoseAttempt refined(const internal::PoseAttempt& found, const ScanPriors& priors, const ScanInWork& scan,
                                std::optional<internal::ScanMotion>& motion);

  std::unique_ptr<internal::PoseFinder> finder_;
  std::unique_ptr<OngoingSearch> ongoing_search_;
  std::unique_ptr<Moving> moving_;  // null: scans are taken as they are
};

}  // namespace saw_ndt
