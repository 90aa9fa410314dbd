#pragma once

#include <cstddef>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {

/// Two stamps no farther apart than this are of the same scan.
constexpr double kStampTolerance_s = 0.01;

/// An estimated pose and the reference of the same scan, both in the map frame.
struct PosePair {
  double stamp_s = 0.0;  ///< of the estimate
  Eigen::Isometry3d T_map_reference = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_map_estimate = Eigen::Isometry3d::Identity();
};

/// How the poses of two trajectories are paired.
struct PairingOptions {
  double skip_s = 0.0;                          ///< left out at the start, from the estimate's first stamp; 0 or more
  double max_difference_s = kStampTolerance_s;  ///< of the two stamps of a pair; 0 or more
  double offset_s = 0.0;                        ///< added to the stamps of the estimate
  bool interpolate = false;                     ///< the reference, between its two poses around an estimated one
  double longest_gap_s = 1.0;                   ///< between such two poses; positive

  /// Throws std::invalid_argument that names the field and its value.
  SAW_NDT_EXPORT void check() const;
};

/// The pairs of two trajectories, in the order of their stamps, and how many poses they were found among.
struct PairedTrajectories {
  std::vector<PosePair> pairs;       ///< at least one
  std::size_t reference_poses = 0;   ///< of the reference
  std::size_t estimate_poses = 0;    ///< of the estimate, without those that are skipped
  std::size_t paired_estimates = 0;  ///< those of the latter that are in a pair
  /// paired_estimates / estimate_poses
  double pairedShare() const { return static_cast<double>(paired_estimates) / static_cast<double>(estimate_poses); }
};

/// Gives poses of one trajectory the pose of the other that is nearest in time.
///
/// Each pose of the trajectory that has fewer (of the estimate, where both have as many) gets the nearest one of the
/// other, the earlier of two that are as near, and is left out where that is more than max_difference_s away, to within
/// a microsecond, which is what stamps of today keep in a double. Several poses may share one of the other trajectory.
/// Where `interpolate` is set, each estimated pose gets the reference at its own moment instead; it is left out before
/// the first and after the last reference and in gaps of more than longest_gap_s. Poses of the first skip_s seconds are
/// left out (a pose at exactly skip_s counts), after the nearest ones have been found.
///
/// Throws std::invalid_argument, saying why, where no pair is left, where a pose or stamp is not finite, and where
/// poses of one trajectory have the same stamp and are more than a centimetre apart.
SAW_NDT_EXPORT PairedTrajectories pairTrajectories(const std::vector<StampedPose>& reference,
                                                   const std::vector<StampedPose>& estimate,
                                                   const PairingOptions& options);

/// The pairs alone, by all other options' defaults.
SAW_NDT_EXPORT std::vector<PosePair> matchTrajectories(const std::vector<StampedPose>& reference,
                                                       const std::vector<StampedPose>& estimate, double skip_s);

}  // namespace saw_ndt
