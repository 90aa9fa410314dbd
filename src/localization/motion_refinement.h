#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "localization/motion_compensation.h"
#include "registration/ndt_evaluation.h"
#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/registration/alignment.h"

namespace saw_ndt::internal {

/// What is known of the motion during a scan before it is registered.
struct MotionPrior {
  /// That until the stamp, where it was measured.
  std::optional<BodyMotion> before;
  /// Otherwise it leads evenly from this pose to that of the scan.
  std::optional<Eigen::Isometry3d> T_map_base_last;
  double since_last_s = 0.0;
  /// How far the motion from the stamp on differs from what goes on of that until then (see planarPart()), one sigma
  /// by (velocity, turn rate); with neither of them known, how far the even motion of the scan differs from standing.
  Vector6d sigmas = Vector6d::Ones();

  bool tellsBefore() const { return before || T_map_base_last; }
  /// @param change  by (velocity, turn rate), that `sigmas` are of
  ScanMotion motionTo(const Eigen::Isometry3d& T_map_base, const Vector6d& change) const;
};

/// A scan of a moving LiDAR registered together with its motion.
struct RefinedMotion {
  Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();
  ScanMotion motion;
  /// Whether the motion differs from standing by more than chance explains: a squared Mahalanobis distance over 22.5.
  bool significant = false;
};

/// Seeks the pose x and the change u of MotionPrior at which a compensated scan has its greatest posterior,
///   score(x, u) / covariance_scale - 1/2 sum (u_k / sigma_k)^2,
/// by damped Gauss-Newton steps on all twelve numbers. The points are taken in a few parts by their times, for a change
/// of the motion moves all points of a part like a change of the pose, times their time.
class SAW_NDT_EXPORT MotionRefinement {
 public:
  /// @param options  of the alignments; weights and levels are theirs
  explicit MotionRefinement(const AlignmentOptions& options) : options_(options) {}

  /// @param source       with times
  /// @param T_map_base   to start from
  /// @param motion       likewise; taken as MotionPrior can tell it
  /// @return nothing where the scan meets no voxel
  std::optional<RefinedMotion> refine(const NdtTarget& target, const MovingSource& source,
                                      const Eigen::Isometry3d& T_map_base, const ScanMotion& motion,
                                      const MotionPrior& prior);

 private:
  static constexpr std::size_t kParts = 12;
  using Vector12d = Eigen::Matrix<double, 12, 1>;
  using Matrix12d = Eigen::Matrix<double, 12, 12>;

  struct Part {
    SourcePoints measured;
    SourcePoints moved;
    std::vector<float> times_s;
    double mean_time_s = 0.0;
    NdtEvaluation evaluation;
  };
  struct State {
    Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();
    Vector6d change = Vector6d::Zero();
    double score = 0.0;  // of the posterior, times covariance_scale
    Vector12d gradient = Vector12d::Zero();
    Matrix12d curvature = Matrix12d::Zero();
    std::size_t pair_count = 0;
  };

  void divide(const MovingSource& moving);
  void evaluate(const MotionPrior& prior, State& state);

  NdtTarget target_;  // of the scan in work
  AlignmentOptions options_;
  std::array<Part, kParts> parts_;
};

}  // namespace saw_ndt::internal
