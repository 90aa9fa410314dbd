#include "registration/score_function.h"

#include <cmath>

namespace saw_ndt::internal {

ScoreParameters scoreParameters(ScoreFunction function, double outlier_ratio, double resolution_m) {
  if (function == ScoreFunction::PAPER) return {1.0, 1.0};
  const double c1 = 10.0 * (1.0 - outlier_ratio);
  const double c2 = outlier_ratio / (resolution_m * resolution_m * resolution_m);
  // -log(c1 + c2) + log(c2) and its like at one standard deviation; log1p keeps digits where c2 is huge.
  const double d1 = -std::log1p(c1 / c2);
  const double at_one_sigma = -std::log1p(c1 / c2 * std::exp(-0.5));
  return {-d1, -2.0 * std::log(at_one_sigma / d1)};
}

}  // namespace saw_ndt::internal
