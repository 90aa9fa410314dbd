#pragma once

namespace saw_ndt {

/// The function of the squared Mahalanobis distance m that a source-voxel pair scores: amplitude * exp(-d2 / 2 * m).
enum class ScoreFunction {
  Magnusson,  ///< eq. 6.8 to 6.10 of Magnusson (2009): a normal distribution mixed with uniform outliers, as PCL
  Paper,      ///< eq. (2) of the weighted NDT paper: amplitude 1, d2 = 1
};

struct ScoreParameters {
  double amplitude = 1.0;  ///< -d1 of Magnusson, positive
  double d2 = 1.0;
};

/// @param outlier_ratio  share of outliers, in (0, 1); Magnusson's function alone depends on it
/// @param resolution_m   edge of the voxels
ScoreParameters scoreParameters(ScoreFunction function, double outlier_ratio, double resolution_m);

}  // namespace saw_ndt
