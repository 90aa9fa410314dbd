#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "saw_ndt/localization/global_search.h"
#include "saw_ndt/localization/localizer.h"
#include "saw_ndt/localization/pose_judge.h"
#include "saw_ndt/map/tiled_target.h"
#include "saw_ndt/registration/ndt_aligner.h"

namespace saw_ndt::internal {

/// An alignment, and what is thought of it.
struct SAW_NDT_EXPORT PoseAttempt {
  AlignmentResult alignment;
  Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();  ///< along free directions the expected pose
  Acceptance acceptance = Acceptance::NOT_CONVERGED;
  SearchExtent search = SearchExtent::NONE;  ///< EVERYWHERE: without regard to what was expected

  bool accepted() const { return acceptance == Acceptance::ACCEPTED; }
};

/// Finds the pose of a scan: from the prediction, from the last pose, from where a search finds the scan around the
/// prediction, or everywhere. A pose in doubt is compared with others. Copies share target and search alone.
class SAW_NDT_EXPORT PoseFinder {
 public:
  /// Finds without a target: nothing but the aligner tells of poses.
  PoseFinder(SourceAligner aligner, const LocalizerOptions& options);
  /// Aligns to a target by the alignment of the options, and searches it.
  PoseFinder(const TiledTarget& target, const LocalizerOptions& options);

  /// What the scan is registered to at a pose. @pre there is a target
  /// @param further_m  how far from there the scan may be taken to be as well
  NdtTarget targetAt(const Eigen::Isometry3d& T_map_base, double further_m = 0.0) {
    return target_->at(T_map_base.translation(), further_m > 0.0 ? target_->reach() + further_m : 0.0);
  }
  /// Prepares for scans to come.
  void loadAhead(const Eigen::Isometry3d& T_map_base, const Eigen::Vector3d& velocity_mps) {
    if (target_) target_->loadAhead(T_map_base.translation(), velocity_mps);
  }
  /// What became of loading tiles; null without a target.
  const TileLoads* tileLoads() const { return target_ ? &target_->loads() : nullptr; }

  bool canSearch() const { return search_.has_value(); }
  /// Whether another place may tell more than what was found. Not where the scan fits as usual but does not say where
  /// along something it was taken: it would fit no better anywhere.
  bool isWorthSearching(const PoseAttempt& found, const TrackState& track) const;
  /// Whether a prediction of that covariance is of any use.
  static bool isInReach(const Matrix6d& covariance);
  /// From the prediction and around it; not at all where that is not in reach.
  PoseAttempt find(const SourcePoints& source, const PoseExpectation& expectation, const TrackState& track);
  /// Without regard to a prediction. @pre canSearch()
  PoseAttempt findAnywhere(const SourcePoints& source, const TrackState& track = {});

  /// From one pose alone, such as that of a scan whose points were not quite the same.
  /// @param expectation  null: nothing is expected
  PoseAttempt findFrom(const SourcePoints& source, const Eigen::Isometry3d& T_map_base_start,
                       const PoseExpectation* expectation, const TrackState& track) {
    return fromStarts(source, {T_map_base_start}, expectation, track);
  }
  /// An alignment alone.
  AlignmentResult align(const SourcePoints& source, const Eigen::Isometry3d& T_map_base_start);

  const PoseJudge& judge() const { return judge_; }

 private:
  PoseAttempt attempt(const SourcePoints& source, const Eigen::Isometry3d& T_map_base_start,
                      const PoseExpectation& expectation);
  void confirmFreeDirections(const SourcePoints& source, AlignmentResult& alignment);
  std::vector<Eigen::Isometry3d> rivalsOf(const SourcePoints& source, const PoseAttempt& found,
                                          const std::vector<Eigen::Isometry3d>& other_starts,
                                          const PoseExpectation& expectation, const TrackState& track);
  PoseAttempt withoutRivals(const SourcePoints& source, const PoseAttempt& found,
                            const std::vector<Eigen::Isometry3d>& other_starts, const PoseExpectation& expectation,
                            const TrackState& track);
  // A pose that judge() accepts, compared with rivals and with what is found from other starts where it is in doubt.
  PoseAttempt settled(const SourcePoints& source, const PoseAttempt& found,
                      const std::vector<Eigen::Isometry3d>& other_starts, const PoseExpectation& expectation,
                      const TrackState& track);
  PoseAttempt fromPrediction(const SourcePoints& source, const PoseExpectation& expectation, const TrackState& track);
  // The best candidates of a search; nothing as region: everywhere.
  std::vector<Eigen::Isometry3d> searchedStarts(const SourcePoints& source,
                                                const std::optional<SearchRegion>& region) const;
  // The first that is accepted; null as expectation: the vehicle may be anywhere.
  PoseAttempt fromStarts(const SourcePoints& source, const std::vector<Eigen::Isometry3d>& starts,
                         const PoseExpectation* expectation, const TrackState& track);

  SourceAligner aligner_;  // null: to the target
  NdtAligner ndt_aligner_;
  AlignmentOptions alignment_;
  std::optional<TiledTarget> target_;
  std::optional<GlobalSearch> search_;
  PoseJudge judge_;
  double min_advantage_sigmas_;
  int threads_;
};

}  // namespace saw_ndt::internal
