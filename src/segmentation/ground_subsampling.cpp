#include "saw_ndt/segmentation/ground_subsampling.h"

#include <pcl/point_types.h>

#include "saw_ndt/common/error.h"
#include "saw_ndt/segmentation/impl/ground_subsampling.hpp"

namespace saw_ndt {

void GroundSubsamplingOptions::check() const {
  checkOption(ground_ratio >= 0.0 && ground_ratio <= 1.0, "ground_ratio", ground_ratio, "0 to 1");
}

GroundSampler::GroundSampler(const GroundSubsamplingOptions& options) : ratio_(options.ground_ratio) {
  options.check();
}

void subsampleGround(const std::vector<StructuralLabel>& labels, const GroundSubsamplingOptions& options,
                     pcl::Indices& kept) {
  GroundSampler sampler(options);
  kept.clear();
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] != StructuralLabel::Ground || sampler.keepsNext()) kept.push_back(static_cast<pcl::index_t>(i));
  }
}

}  // namespace saw_ndt

SAW_NDT_INSTANTIATE_GroundSubsampling(pcl::PointXYZ) SAW_NDT_INSTANTIATE_GroundSubsampling(pcl::PointXYZI)
    SAW_NDT_INSTANTIATE_GroundSubsampling(pcl::PointXYZL)
