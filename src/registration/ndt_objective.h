#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "map/ndt_level.h"
#include "registration/ndt_derivatives.h"
#include "registration/score_function.h"
#include "saw_ndt/registration/alignment.h"
#include "saw_ndt/registration/source_points.h"

namespace saw_ndt::internal {

/// W_ij of eq. (1) of the paper, or 1 for every pair.
struct PairWeighting {
  bool enabled = false;
  double mismatch_penalty = 0.1;  ///< lambda_m, what is left of a pair of opposite pure labels
  ConfidenceOptions confidence;   ///< s of a source point by its label
};

/// eta of the paper: how well a source point's confidence agrees with a voxel's mean confidence, from mismatch_penalty
/// to 1.
double compatibility(double source_confidence, double voxel_mean_confidence, const PairWeighting& weighting);

/// The weighted NDT score (eq. (2) of the paper) of a source against one map level, with derivatives.
class NdtObjective {
 public:
  /// @param level  is referred to, not copied
  /// @throws std::invalid_argument where the level has no cells in double precision
  NdtObjective(const internal::NdtLevel& level, NeighborhoodSearchMethod method, const ScoreParameters& score,
               const PairWeighting& weighting);

  /// What one call leaves for the next, so that none allocates.
  struct Workspace {
    std::vector<NdtDerivatives> blocks;
  };

  /// Score and derivatives at a pose, over every `stride`-th source point. The sum is made of fixed blocks added in
  /// order: the same bits for any number of threads.
  NdtDerivatives evaluate(const SourcePoints& source, const Eigen::Isometry3d& T_map_source, int threads,
                          Workspace& workspace, std::size_t stride = 1) const;

 private:
  template <NeighborhoodSearchMethod method, bool weighted>
  void evaluateBlock(const SourcePoints& source, const Eigen::Isometry3d& T_map_source, std::size_t first,
                     std::size_t last, std::size_t stride, NdtDerivatives& sums) const;

  const internal::NdtLevel& level_;
  NeighborhoodSearchMethod method_;
  ScoreParameters score_;
  PairWeighting weighting_;
};

}  // namespace saw_ndt::internal
