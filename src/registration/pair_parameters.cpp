#include "registration/pair_parameters.h"

#include <cmath>

namespace saw_ndt::internal {

PairParameters pairParameters(const internal::NdtLevel& level, NeighborhoodSearchMethod method,
                              const ScoreParameters& score, const PairWeighting& weighting) {
  PairParameters parameters{};
  parameters.cells = level.packedCells().data();
  parameters.amplitude = static_cast<float>(score.amplitude);
  parameters.exponent_factor = static_cast<float>(-0.5 * score.d2 / std::log(2.0));
  parameters.weighted = weighting.enabled;
  const double range = std::abs(weighting.confidence.non_ground - weighting.confidence.ground);
  const double mismatch = 1.0 - weighting.mismatch_penalty;
  parameters.min_compatibility = static_cast<float>(weighting.mismatch_penalty);
  parameters.mismatch_slope = range > 0.0 ? static_cast<float>(mismatch / range) : 0.0F;
  parameters.within_radius = method == NeighborhoodSearchMethod::RADIUS;
  parameters.radius_m = static_cast<float>(level.resolution());
  return parameters;
}

}  // namespace saw_ndt::internal
