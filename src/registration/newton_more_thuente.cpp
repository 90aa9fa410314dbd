#include <Eigen/QR>
#include <cmath>

#include "registration/line_search.h"
#include "registration/optimizers.h"
#include "saw_ndt/registration/source_points.h"

namespace saw_ndt::internal {

void newtonMoreThuente(const Evaluation& evaluate, const StepLimits& limits, double line_search_min_step,
                       double line_search_max_step, AlignmentResult& result) {
  Vector6d pose;
  pose << result.T_map_source.translation(), eulerFromRotation(result.T_map_source.linear());
  const auto transformOf = [](const Vector6d& x) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() = x.head<3>();
    T.linear() = rotationFromEuler(x.tail<3>());
    return T;
  };
  NdtDerivatives derivatives;
  const auto evaluateAt = [&](const Vector6d& x) {
    derivatives = evaluate(transformOf(x));
    ++result.evaluations;
    return eulerDerivatives(derivatives, x.tail<3>());
  };

  EulerDerivatives at = evaluateAt(pose);
  result.status = derivatives.pair_count == 0 ? AlignmentStatus::NO_OVERLAP : AlignmentStatus::ITERATION_LIMIT;
  while (result.status == AlignmentStatus::ITERATION_LIMIT && result.iterations < limits.max_iterations) {
    // Least squares, so that a direction which nothing constrains is left alone.
    Vector6d direction = at.hessian.completeOrthogonalDecomposition().solve(-at.gradient);
    const double length = direction.norm();
    if (!std::isfinite(length)) break;
    ++result.iterations;
    if (length == 0.0) {
      result.status = AlignmentStatus::CONVERGED;
      break;
    }
    direction /= length;
    double slope = -at.gradient.dot(direction);
    if (slope > 0.0) {
      direction = -direction;
      slope = -slope;
    }
    const auto along = [&](double step) {
      at = evaluateAt(pose + step * direction);
      return ValueAndSlope{-at.score, -at.gradient.dot(direction)};
    };
    const double step = moreThuenteStep(along, {-at.score, slope}, length, line_search_min_step, line_search_max_step);
    pose += step * direction;
    if (step * direction.head<3>().norm() <= limits.translation_epsilon_m &&
        step * direction.tail<3>().norm() <= limits.rotation_epsilon_rad) {
      result.status = AlignmentStatus::CONVERGED;
    }
  }
  // A least step as long as the caller likes may lead anywhere.
  if (!pose.allFinite() || pose.head<3>().cwiseAbs().maxCoeff() > kFarthest_m) {
    result.status = AlignmentStatus::UNDETERMINED;
    return;
  }
  result.T_map_source = transformOf(pose);
  result.score = at.score;
  result.information = derivatives.curvature;
}

}  // namespace saw_ndt::internal
