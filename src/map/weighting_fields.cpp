#include "map/weighting_fields.h"

#include <stdexcept>

#include "map/metadata_lines.h"
#include "segmentation/segmentation_fields.h"

namespace saw_ndt::internal {
namespace {

template <typename Weighting, typename Visit>
void forEachWeightingField(Weighting& weighting, const Visit& visit) {
  visit("weighting.confidence.noise", weighting.confidence.noise);
  visit("weighting.confidence.ground", weighting.confidence.ground);
  visit("weighting.confidence.non_ground", weighting.confidence.non_ground);
  visit("weighting.linear_alpha", weighting.linear_alpha);
  visit("weighting.planar_alpha", weighting.planar_alpha);
  visit("weighting.volumetric_alpha", weighting.volumetric_alpha);
  visit("weighting.min_points_per_voxel", weighting.min_points_per_voxel);
  visit("weighting.min_eigenvalue_ratio", weighting.min_eigenvalue_ratio);
  visit("weighting.unbounded_ground", weighting.unbounded_ground);
  visit("weighting.sizes.finest_m", weighting.sizes.finest_m);
  visit("weighting.sizes.coarsest_m", weighting.sizes.coarsest_m);
  visit("weighting.sizes.min_scans", weighting.sizes.min_scans);
  visit("weighting.sizes.min_spread", weighting.sizes.min_spread);
  visit("weighting.coarse_factor", weighting.coarse_factor);
}

}  // namespace

std::string weightingText(const VoxelWeighting& weighting) {
  std::string text;
  forEachWeightingField(
      weighting, [&text](const char* name, const auto& value) { appendMetadataLine(name, fieldText(value), text); });
  return text;
}

std::optional<MetadataFault> readWeighting(std::string_view text, VoxelWeighting& weighting) {
  MetadataLines lines(text);
  if (lines.fault()) return lines.fault();
  VoxelWeighting read;
  forEachWeightingField(read, [&lines](const char* name, auto& value) { lines.read(name, value); });
  try {
    if (!lines.fault()) read.check();
  } catch (const std::invalid_argument& error) {
    lines.fail(0, std::string("damaged: the metadata gives weighting.") + error.what());
  }
  if (!lines.fault()) weighting = read;
  return lines.fault();
}

}  // namespace saw_ndt::internal
