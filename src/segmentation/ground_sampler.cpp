#include "saw_ndt/segmentation/ground_sampler.h"

#include "saw_ndt/common/error.h"

namespace saw_ndt {

void GroundSubsamplingOptions::check() const {
  checkOption(ground_ratio >= 0.0 && ground_ratio <= 1.0, "ground_ratio", ground_ratio, "0 to 1");
}

GroundSampler::GroundSampler(const GroundSubsamplingOptions& options) : ratio_(options.ground_ratio) {
  options.check();
}

}  // namespace saw_ndt
