#pragma once

#include "saw_ndt/map/weighted_voxel_map.h"
#include "saw_ndt/registration/alignment.h"

namespace saw_ndt {

/// Registers source points to a map. Holds nothing but scratch memory that calls reuse: not to be shared by threads
/// that call it at the same time.
class NdtAligner {
 public:
  /// @param guess  T_map_source to start from
  /// @throws std::invalid_argument for options that do not hold or a guess that is not finite
  AlignmentResult align(const WeightedVoxelMap& map, const SourcePoints& source, const Eigen::Isometry3d& guess,
                        const AlignmentOptions& options);

  /// Score and derivatives on the fine level at one pose.
  NdtDerivatives evaluate(const WeightedVoxelMap& map, const SourcePoints& source,
                          const Eigen::Isometry3d& T_map_source, const AlignmentOptions& options);

 private:
  NdtObjective::Workspace workspace_;
};

}  // namespace saw_ndt
