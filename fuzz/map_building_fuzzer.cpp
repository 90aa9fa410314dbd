// Maps of scans anywhere: their statistics, and what is left of them when they are saved and packed.
#include <stdexcept>

#include "fuzzed_clouds.h"
#include "fuzzed_file.h"
#include "saw_ndt/localization/map_pack.h"
#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/map/weighted_map_builder.h"

namespace saw_ndt {
namespace {

VoxelWeighting anyWeighting(FuzzedDataProvider& provider) {
  VoxelWeighting weighting;
  weighting.unbounded_ground = provider.ConsumeBool();
  weighting.min_points_per_voxel = 3 + provider.ConsumeIntegral<std::uint8_t>() % 8;
  weighting.coarse_factor = 1 + provider.ConsumeIntegral<std::uint8_t>() % 4;
  if (provider.ConsumeBool()) weighting.sizes.coarsest_m = 4.0;
  return weighting;
}

void addScans(FuzzedDataProvider& provider, WeightedMapBuilder& builder) {
  const bool labelled = provider.ConsumeBool();
  for (int scans = 0; scans < 3 && provider.remaining_bytes() > 0; ++scans) {
    const ScanPoints scan = anyScan(provider);
    const std::vector<StructuralLabel> labels = anyLabels(provider, scan.points.size());
    const Eigen::Isometry3d T_map_scan = anyPose(provider, 100.0);
    try {
      builder.addScan(viewOf(scan), labelled ? LabelView(labels) : LabelView(), T_map_scan, 1);
    } catch (const std::invalid_argument&) {  // of a pose that is none
    }
  }
}

}  // namespace
}  // namespace saw_ndt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace saw_ndt;
  static const TemporaryFolder folder;
  static const std::string map_file = folder.path() / "built.map", packed_file = folder.path() / "packed.map";
  FuzzedDataProvider provider(data, size);
  constexpr double kResolutions_m[] = {1.0, 0.5, 0.1, 20.0};
  WeightedMapBuilder builder(kResolutions_m[provider.ConsumeIntegral<std::uint8_t>() % std::size(kResolutions_m)]);
  const VoxelWeighting weighting = anyWeighting(provider);
  const bool packs = provider.ConsumeBool();
  addScans(provider, builder);
  const WeightedVoxelMap map = builder.build();
  for (const VoxelStatistics& voxel : map.statistics(weighting, 1)) {
    require(voxel.mean_from_centre.allFinite() && voxel.covariance.allFinite() && voxel.inverse_covariance.allFinite(),
            "statistics are finite");
  }
  const NdtTarget target(map, weighting, 1);
  for (const Eigen::Vector3d& mean : target.means()) require(mean.allFinite(), "means are finite");
  if (!packs) return 0;
  builder.save(map_file, 1);
  require(NdtTarget::load(map_file, weighting, 1).voxelCount() == target.voxelCount(), "a saved map has all voxels");
  try {
    packMap(map_file, packed_file, weighting, 1);
  } catch (const Error&) {  // of voxels too far above each other
    return 0;
  }
  require(NdtTarget::load(packed_file, weighting, 1).voxelCount() == target.voxelCount(), "a packed map, too");
  return 0;
}
