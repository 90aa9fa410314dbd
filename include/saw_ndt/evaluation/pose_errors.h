#pragma once

#include <cstddef>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/evaluation/pose_pairs.h"

namespace saw_ndt {

/// Statistics of errors e_1 ... e_n, in their unit; sse in its square.
struct ErrorStatistics {
  double rmse = 0.0;    ///< sqrt(sse / n)
  double mean = 0.0;    ///< sum e_i / n
  double median = 0.0;  ///< the middle one, or the mean of the middle two
  double std = 0.0;     ///< sqrt(sum (e_i - mean)^2 / n)
  double min = 0.0;
  double max = 0.0;
  double sse = 0.0;  ///< sum e_i^2
};

/// Throws std::invalid_argument where there is none.
SAW_NDT_EXPORT ErrorStatistics errorStatistics(const std::vector<double>& errors);

/// Errors of poses, each the size of a transform E that would be the identity, were the estimate exact.
struct PoseErrorStatistics {
  ErrorStatistics translation_m;  ///< |t| of E = [R t]
  ErrorStatistics rotation_deg;   ///< the angle of R
  ErrorStatistics full;           ///< the Frobenius norm of E - I, sqrt(|R - I|^2 + |t|^2), of mixed units
};

/// The absolute pose error: E = T_map_estimate^-1 T_map_reference of every pair. Throws std::invalid_argument where
/// there is no pair.
SAW_NDT_EXPORT PoseErrorStatistics absolutePoseErrors(const std::vector<PosePair>& pairs);

/// Which poses the relative error compares.
struct RelativeErrorOptions {
  enum class Unit {
    FRAMES,  ///< poses of the pairs
    METRES,  ///< of the way along the trajectory
  };
  Unit unit = Unit::FRAMES;
  double delta = 1.0;               ///< from a pose to the other; in FRAMES a whole number of 1 or more, else positive
  bool all_pairs = false;           ///< from every pose, else each from where the one before ended
  bool way_of_reference = false;    ///< METRES are those of the reference's way, else of the estimate's
  double relative_tolerance = 0.1;  ///< of the way, with all_pairs: a share of delta; 0 or more

  /// Throws std::invalid_argument that names the field and its value.
  SAW_NDT_EXPORT void check() const;
};

/// The error of the motion between two poses.
struct RelativePoseError {
  std::size_t first = 0, last = 0;  ///< the pairs of poses, from 0
  double translation_m = 0.0;       ///< |t| of E = [R t]
  double rotation_deg = 0.0;        ///< the angle of R
  double full = 0.0;                ///< the Frobenius norm of E - I
};

/// The relative pose error between poses i and j: E = (T_map_reference_i^-1 T_map_reference_j)^-1
/// (T_map_estimate_i^-1 T_map_estimate_j).
///
/// FRAMES: j = i + delta; i is every pose with all_pairs, else 0, delta, 2 delta ... METRES: with all_pairs, j is the
/// later pose whose way from i is nearest to delta, and i is left out where that is more than relative_tolerance *
/// delta off; else the ends are the poses at which the way since the end before first reaches delta, and the way to the
/// first end is not evaluated. Throws std::invalid_argument, saying why, where no two poses are so far apart.
SAW_NDT_EXPORT std::vector<RelativePoseError> relativePoseErrors(const std::vector<PosePair>& pairs,
                                                                 const RelativeErrorOptions& options);

/// Throws std::invalid_argument where there is none.
SAW_NDT_EXPORT PoseErrorStatistics statisticsOf(const std::vector<RelativePoseError>& errors);

}  // namespace saw_ndt
