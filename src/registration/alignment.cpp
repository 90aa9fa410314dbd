#include "saw_ndt/registration/alignment.h"

#include <array>
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
  checkOption(min_overlap >= 0.0 && min_overlap <= 1.0, "min_overlap", min_overlap, "between 0 and 1");
  checkOption(positive(covariance_scale), "covariance_scale", covariance_scale, "positive");
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
    case AlignmentStatus::UNDETERMINED:
      return "too few points fit the target";
  }
  return "unknown";
}

namespace {

// From the axes of the map to those of the base.
Matrix6d inBase(const Matrix6d& in_map, const Eigen::Matrix3d& R_map_base) {
  Matrix6d R = Matrix6d::Zero();
  R.topLeftCorner<3, 3>() = R.bottomRightCorner<3, 3>() = R_map_base.transpose();
  return R * in_map * R.transpose();
}

}  // namespace

Matrix6d freeCovariance(const PoseDirections& free_directions) {
  PoseDirections motions = free_directions;
  motions.bottomRows<3>() /= kRotationArm_m;
  return kFreeSigma_m * kFreeSigma_m * motions * motions.transpose();
}

std::string freeAxes(const PoseDirections& free_directions, const Eigen::Matrix3d& R_map_base) {
  // A direction half way between two axes names both.
  constexpr double kNamedShare = 0.25;
  constexpr std::array<const char*, 6> kNames{"x", "y", "z", "roll", "pitch", "yaw"};
  const Vector6d share = inBase(free_directions * free_directions.transpose(), R_map_base).diagonal();
  std::string names;
  for (std::size_t k = 0; k < kNames.size(); ++k) {
    if (share[static_cast<Eigen::Index>(k)] < kNamedShare) continue;
    if (!names.empty()) names += ' ';
    names += kNames[k];
  }
  return names;
}

Vector6d standardDeviations(const Matrix6d& covariance, const Eigen::Matrix3d& R_map_base) {
  return inBase(covariance, R_map_base).diagonal().cwiseMax(0.0).cwiseSqrt();
}

}  // namespace saw_ndt
