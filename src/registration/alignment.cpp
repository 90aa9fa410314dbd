#include "saw_ndt/registration/alignment.h"

#include <cmath>

#include "saw_ndt/common/error.h"

namespace saw_ndt {

void AlignmentOptions::check() const {
  const auto positive = [](double value) { return value > 0.0 && std::isfinite(value); };
  checkOption(outlier_ratio > 0.0 && outlier_ratio < 1.0, "outlier_ratio", outlier_ratio, "between 0 and 1, exclusive");
  checkOption(mismatch_penalty >= 0.0 && mismatch_penalty <= 1.0, "mismatch_penalty", mismatch_penalty,
              "between 0 and 1");
  checkOption(max_iterations >= 1, "max_iterations", max_iterations, "1 or more");
  checkOption(positive(translation_epsilon_m), "translation_epsilon_m", translation_epsilon_m, "positive");
  checkOption(positive(rotation_epsilon_rad), "rotation_epsilon_rad", rotation_epsilon_rad, "positive");
  checkOption(positive(max_step_m), "max_step_m", max_step_m, "positive");
  checkOption(min_curvature_share > 0.0 && min_curvature_share <= 1.0, "min_curvature_share", min_curvature_share,
              "above 0 and at most 1");
  checkOption(coarse_max_iterations >= 1, "coarse_max_iterations", coarse_max_iterations, "1 or more");
  checkOption(coarse_stride >= 1, "coarse_stride", coarse_stride, "1 or more");
  checkOption(positive(coarse_settled_voxels), "coarse_settled_voxels", coarse_settled_voxels, "positive");
  checkOption(positive(line_search_max_step), "line_search_max_step", line_search_max_step, "positive");
  checkOption(line_search_min_step >= 0.0 && std::isfinite(line_search_min_step), "line_search_min_step",
              line_search_min_step, "0 or more");
  checkOption(threads >= 0, "threads", threads, "0 or more");
}

const char* toString(AlignmentStatus status) {
  switch (status) {
    case AlignmentStatus::CONVERGED:
      return "converged";
    case AlignmentStatus::ITERATION_LIMIT:
      return "iteration limit";
    case AlignmentStatus::NO_OVERLAP:
      return "no overlap";
    case AlignmentStatus::NO_SOURCE:
      return "no source";
    case AlignmentStatus::NO_TARGET:
      return "no target";
  }
  return "unknown";
}

}  // namespace saw_ndt
