#pragma once

#include <memory>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/registration/alignment.h"
#include "saw_ndt/registration/source_points.h"

namespace saw_ndt {

/// Tells how well many poses explain one source: what can be done once for all of them is. Not to be shared by threads
/// that call it at the same time.
class SAW_NDT_EXPORT PoseScorer {
 public:
  /// Takes the source over.
  /// @param outlier_ratio  of Magnusson's score function, in (0, 1)
  /// @throws std::invalid_argument where it is not, or where a point of the source is not within reach or has no label
  PoseScorer(const NdtTarget& target, const SourcePoints& source,
             double outlier_ratio = AlignmentOptions().outlier_ratio);
  ~PoseScorer();
  PoseScorer(PoseScorer&& other) noexcept;
  PoseScorer& operator=(PoseScorer&& other) noexcept;

  /// The likelihoods at each pose, T_map_source. They depend on that pose alone.
  /// @param threads  0: all cores; the likelihoods do not depend on it
  std::vector<Likelihoods> score(const std::vector<Eigen::Isometry3d>& poses, int threads = 0);

 private:
  struct Parts;

  std::unique_ptr<Parts> parts_;
};

}  // namespace saw_ndt
