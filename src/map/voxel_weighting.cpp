#include "saw_ndt/map/voxel_weighting.h"

#include <cmath>

#include "saw_ndt/common/error.h"

namespace saw_ndt {

void ConfidenceOptions::check() const {
  const auto in_unit_interval = [](double value) { return value >= 0.0 && value <= 1.0; };
  checkOption(in_unit_interval(noise), "confidence.noise", noise, "between 0 and 1");
  checkOption(in_unit_interval(ground), "confidence.ground", ground, "between 0 and 1");
  checkOption(in_unit_interval(non_ground), "confidence.non_ground", non_ground, "between 0 and 1");
}

void VoxelSizes::check() const {
  const auto not_negative = [](double value) { return value >= 0.0 && std::isfinite(value); };
  checkOption(not_negative(finest_m), "sizes.finest_m", finest_m, "0 or more");
  checkOption(not_negative(coarsest_m), "sizes.coarsest_m", coarsest_m, "0 or more");
  checkOption(min_scans >= 0, "sizes.min_scans", min_scans, "0 or more");
  checkOption(min_spread >= 0.0 && min_spread < 0.5, "sizes.min_spread", min_spread, "0 or more and below 0.5");
}

void VoxelWeighting::check() const {
  confidence.check();
  sizes.check();
  const auto positive = [](double value) { return value > 0.0 && std::isfinite(value); };
  checkOption(positive(linear_alpha), "linear_alpha", linear_alpha, "positive");
  checkOption(positive(planar_alpha), "planar_alpha", planar_alpha, "positive");
  checkOption(positive(volumetric_alpha), "volumetric_alpha", volumetric_alpha, "positive");
  checkOption(min_points_per_voxel >= 3, "min_points_per_voxel", min_points_per_voxel, "3 or more");
  checkOption(min_eigenvalue_ratio > 0.0 && min_eigenvalue_ratio <= 1.0, "min_eigenvalue_ratio", min_eigenvalue_ratio,
              "above 0 and at most 1");
  checkOption(coarse_factor >= 1 && coarse_factor <= 16, "coarse_factor", coarse_factor, "between 1 and 16");
}

}  // namespace saw_ndt
