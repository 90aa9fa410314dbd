#pragma once

#include "registration/ndt_evaluation.h"

namespace saw_ndt::internal {

/// What ends a run of steps.
struct StepLimits {
  int max_iterations = 35;
  double translation_epsilon_m = 1e-3;
  double rotation_epsilon_rad = 5e-5;
  double max_step_m = 0.5;
};

/// Ascends from result.T_map_source with Newton steps on SE(3). The quadratic model is solved in the basis in which the
/// curvature and the radial curvature are both diagonal: along each of its directions the true curvature is a share
/// 1 - mu of the Gauss-Newton one, and a share below `min_curvature_share` (negative where the score is convex) is
/// raised to it. A step that does not raise the score is halved.
void dampedNewton(const Evaluation& evaluate, const StepLimits& limits, double min_curvature_share,
                  AlignmentResult& result);

/// Ascends from result.T_map_source as pcl::NormalDistributionsTransform does.
void newtonMoreThuente(const Evaluation& evaluate, const StepLimits& limits, double line_search_min_step,
                       double line_search_max_step, AlignmentResult& result);

}  // namespace saw_ndt::internal
