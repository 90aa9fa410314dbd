#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/evaluation/metrics.h"

namespace saw_ndt {

/// The drift measures of the KITTI odometry benchmark: means over all segments of 100, 200, ... 800 m.
struct KittiRelativeErrors {
  std::size_t segments = 0;
  double translation_percent = 0.0;  ///< translation error over the segment's length
  double rotation_deg_per_m = 0.0;   ///< rotation error over the segment's length
};

/// The relative errors as the KITTI development kit defines them: a segment starts at every 10th pose and ends at the
/// first pose whose path length along the reference exceeds the segment's; its error is the difference of the two
/// relative poses. Empty where the drive is too short for one segment.
SAW_NDT_EXPORT std::optional<KittiRelativeErrors> kittiRelativeErrors(const std::vector<PosePair>& pairs);

}  // namespace saw_ndt
