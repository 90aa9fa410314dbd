// Selection and thinning of a scan's points.
#include <array>
#include <cmath>
#include <optional>

#include "fuzzed_clouds.h"
#include "fuzzed_file.h"
#include "localization/source_voxel_filter.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace saw_ndt;
  FuzzedDataProvider provider(data, size);
  constexpr double kSizes_m[] = {0.0, 0.2, 1.0, 1e-3, 50.0};
  // Kept from input to input, as from scan to scan.
  static std::array<std::optional<internal::SourceVoxelFilter>, std::size(kSizes_m)> filters;
  const std::size_t size_number = provider.ConsumeIntegral<std::uint8_t>() % std::size(kSizes_m);
  if (!filters[size_number]) filters[size_number].emplace(kSizes_m[size_number]);
  internal::SourceVoxelFilter& filter = *filters[size_number];
  internal::SourceSelection selection;
  selection.ground_ratio = provider.ConsumeIntegralInRange<int>(0, 100) / 100.0;
  if (provider.ConsumeBool()) selection.confidence = ConfidenceOptions::paper();
  if (provider.ConsumeBool()) selection.T_base_lidar = anyPose(provider, 5.0);
  for (int scans = 0; scans < 2; ++scans) {
    const ScanPoints scan = anyScan(provider);
    const std::vector<StructuralLabel> labels = anyLabels(provider, scan.points.size());
    const SourcePoints& source = filter.filter(viewOf(scan), provider.ConsumeBool() ? &labels : nullptr, selection);
    require(source.size() <= scan.points.size(), "no points are added");
    require(
        source.y.size() == source.size() && source.z.size() == source.size() && source.label.size() == source.size(),
        "every point has all of its numbers");
    for (std::size_t i = 0; i < source.size(); ++i) {
      require(std::isfinite(source.x[i]) && std::isfinite(source.y[i]) && std::isfinite(source.z[i]),
              "source points are finite");
    }
  }
  return 0;
}
