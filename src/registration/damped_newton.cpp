#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "registration/optimizers.h"

namespace saw_ndt::internal {
namespace {

// Added to the diagonal of the curvature, as a share of its mean over translation and over rotation: directions that
// nothing constrains get a step of (nearly) zero instead of an infinite one.
constexpr double kRidge = 1e-9;

// A step that promises to raise the score by less than this share of it is as good as none: where pairs appear and
// vanish at the faces of voxels, the score has edges on which no step, however short, ends at a slope of zero.
constexpr double kNegligibleGain = 1e-8;

// At the iteration limit a step of so many epsilons counts as converged.
constexpr double kNearlyConverged = 10.0;

Matrix6d ridged(const Matrix6d& curvature) {
  Matrix6d result = curvature;
  const double translation = curvature.diagonal().head<3>().mean();
  const double rotation = curvature.diagonal().tail<3>().mean();
  result.diagonal().head<3>().array() += kRidge * translation + 1e-300;
  result.diagonal().tail<3>().array() += kRidge * rotation + 1e-300;
  return result;
}

Vector6d newtonStep(const NdtDerivatives& at, double min_curvature_share) {
  const Eigen::LLT<Matrix6d> cholesky(ridged(at.curvature));
  const auto L = cholesky.matrixL();
  const Matrix6d half_whitened = L.solve(at.radial_curvature);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(L.solve(half_whitened.transpose()));
  const Vector6d share = (1.0 - solver.eigenvalues().array()).max(min_curvature_share).matrix();
  const Vector6d whitened_gradient = solver.eigenvectors().transpose() * Vector6d(L.solve(at.gradient()));
  const Vector6d whitened_step = solver.eigenvectors() * whitened_gradient.cwiseQuotient(share);
  return cholesky.matrixU().solve(whitened_step);
}

Eigen::Isometry3d moved(const Eigen::Isometry3d& T, const Vector6d& step) {
  Eigen::Isometry3d result = T;
  result.translation() += step.head<3>();
  result.linear() = rotationFromVector(step.tail<3>()) * T.linear();
  return result;
}

}  // namespace

void dampedNewton(const Evaluation& evaluate, const StepLimits& limits, double min_curvature_share,
                  AlignmentResult& result) {
  Eigen::Isometry3d best = result.T_map_source;
  NdtDerivatives at_best = evaluate(best);
  ++result.evaluations;
  const auto finish = [&](AlignmentStatus status) {
    result.status = status;
    result.score = at_best.score;
    result.information = at_best.curvature;
  };
  if (at_best.pair_count == 0) return finish(AlignmentStatus::NO_OVERLAP);

  const auto within_epsilons = [&](const Vector6d& step, double factor) {
    return step.head<3>().norm() < factor * limits.translation_epsilon_m &&
           step.tail<3>().norm() < factor * limits.rotation_epsilon_rad;
  };
  const auto is_small = [&](const Vector6d& step) {
    return within_epsilons(step, 1.0) || at_best.gradient().dot(step) < kNegligibleGain * at_best.score;
  };
  Vector6d step = newtonStep(at_best, min_curvature_share);
  for (int iteration = 0; iteration < limits.max_iterations; ++iteration) {
    if (!step.allFinite()) return finish(AlignmentStatus::NO_OVERLAP);
    const double length = step.head<3>().norm();
    if (length > limits.max_step_m) step *= limits.max_step_m / length;

    const Eigen::Isometry3d trial = normalizedRotation(moved(best, step));
    ++result.iterations;
    if (is_small(step)) {
      result.T_map_source = trial;
      return finish(AlignmentStatus::CONVERGED);
    }
    const NdtDerivatives at_trial = evaluate(trial);
    ++result.evaluations;
    if (at_trial.score > at_best.score) {
      best = trial;
      at_best = at_trial;
      step = newtonStep(at_best, min_curvature_share);
    } else {
      step *= 0.5;
    }
    result.T_map_source = best;
  }
  // Steps of millimetres to and fro about an optimum are not those of metres on the way to one.
  finish(within_epsilons(step, kNearlyConverged) ? AlignmentStatus::CONVERGED : AlignmentStatus::ITERATION_LIMIT);
}

}  // namespace saw_ndt::internal
