#include "fuzzed_clouds.h"
#include "fuzzed_file.h"
#include "saw_ndt/localization/global_search.h"
#include "saw_ndt/map/weighted_map_builder.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace saw_ndt;
  FuzzedDataProvider provider(data, size);
  WeightedMapBuilder builder(1.0);
  const ScanPoints scan = anyScan(provider);
  const std::vector<StructuralLabel> labels = anyLabels(provider, scan.points.size());
  builder.addScan(viewOf(scan), provider.ConsumeBool() ? LabelView(labels) : LabelView(), Eigen::Isometry3d::Identity(),
                  1);
  GlobalSearchOptions options;
  options.heading_step_deg = 20.0;
  options.cells = 64;
  const GlobalSearch search(NdtTarget(builder.build(), {}, 1), options);
  std::optional<SearchRegion> region;
  if (provider.ConsumeBool()) {
    region.emplace();
    region->T_map_base = anyPose(provider, 20.0);
    region->radius_m = provider.ConsumeIntegral<std::uint8_t>();
    if (!region->T_map_base.matrix().allFinite()) return 0;
  }
  const SourcePoints source = anySource(provider);
  for (const PoseCandidate& candidate : search.candidates(source, region, 1)) {
    require(candidate.T_map_base.matrix().allFinite(), "candidates are finite");
    require(candidate.T_map_base.linear().isUnitary(1e-6), "candidates are rigid");
    require(candidate.matched_share >= options.least_share && candidate.matched_share <= 1.0,
            "candidates find enough in the map");
  }
  return 0;
}
