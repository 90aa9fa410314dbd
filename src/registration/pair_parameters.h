#pragma once

#include "registration/ndt_kernel.h"
#include "registration/ndt_objective.h"

namespace saw_ndt::internal {

/// What the inner loops need to know of a level, a score function and weights.
PairParameters pairParameters(const internal::NdtLevel& level, NeighborhoodSearchMethod method,
                              const ScoreParameters& score, const PairWeighting& weighting);

}  // namespace saw_ndt::internal
