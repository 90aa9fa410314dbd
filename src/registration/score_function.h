#pragma once

#include "saw_ndt/registration/alignment.h"

namespace saw_ndt::internal {

struct ScoreParameters {
  double amplitude = 1.0;  ///< -d1 of Magnusson, positive
  double d2 = 1.0;
};

/// @param outlier_ratio  share of outliers, in (0, 1); Magnusson's function alone depends on it
/// @param resolution_m   edge of the voxels
ScoreParameters scoreParameters(ScoreFunction function, double outlier_ratio, double resolution_m);

}  // namespace saw_ndt::internal
