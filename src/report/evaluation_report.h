#pragma once

#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "saw_ndt/evaluation/pose_errors.h"
#include "saw_ndt/evaluation/trajectory_alignment.h"

namespace saw_ndt {

/// Relative errors and what they are of.
struct RelativeEvaluation {
  RelativeErrorOptions options;
  std::vector<RelativePoseError> errors;
};

/// What is told of an estimated trajectory.
struct TrajectoryEvaluation {
  PairedTrajectories paired;  ///< the estimate aligned
  PairingOptions pairing;
  TrajectoryAlignment alignment = TrajectoryAlignment::NONE;
  Eigen::Isometry3d T_reference_estimate = Eigen::Isometry3d::Identity();  ///< the alignment's transform
  std::optional<RelativeEvaluation> by_frames;
  std::optional<RelativeEvaluation> by_metres;
};

/// The evaluation of pairs that are not aligned yet. Throws std::invalid_argument as alignmentTransform() and
/// relativePoseErrors() do.
TrajectoryEvaluation evaluated(PairedTrajectories paired, const PairingOptions& pairing, TrajectoryAlignment alignment,
                               const std::optional<RelativeErrorOptions>& by_frames,
                               const std::optional<RelativeErrorOptions>& by_metres);

/// The object that saw_ndt_evaluate prints; docs/evaluation.md says what its members are.
nlohmann::ordered_json toJson(const TrajectoryEvaluation& evaluation);

/// The same as text: a line a value, and a line for all statistics of one figure.
void writeText(const nlohmann::ordered_json& report, std::ostream& stream);

}  // namespace saw_ndt
