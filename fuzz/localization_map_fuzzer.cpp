// Localization maps, as they are and with checksums that hold: all tiles, tiles around a place, the search.
#include "fuzzed_file.h"
#include "map_checksums.h"
#include "saw_ndt/localization/global_search.h"
#include "saw_ndt/map/localization_map.h"

namespace saw_ndt {
namespace {

SourcePoints wallAndGround() {
  SourcePoints source;
  source.labelled = true;
  for (int i = -20; i <= 20; ++i) {
    const auto along = 0.5F * static_cast<float>(i);
    source.add(along, 4.0F, 0.1F * static_cast<float>(i % 9), StructuralLabel::NON_GROUND);
    source.add(along, -2.0F, -1.7F, StructuralLabel::GROUND);
  }
  return source;
}

void tryMap(FuzzedFile& file, const std::uint8_t* data, std::size_t size) {
  static const SourcePoints source = wallAndGround();
  file.tryReading(data, size, [](const std::filesystem::path& path) {
    const LocalizationMap map(path.string());
    for (const Eigen::Vector3d& mean : map.target(1).means()) require(mean.allFinite(), "means are finite");
    map.targetAround({1.0, 2.0, 0.0}, 10.0, 1);
  });
  file.tryReading(data, size, [](const std::filesystem::path& path) {
    GlobalSearchOptions options;
    options.heading_step_deg = 30.0;
    for (const PoseCandidate& candidate :
         GlobalSearch(LocalizationMap(path.string()), options).candidates(source, {}, 1)) {
      require(candidate.T_map_base.matrix().allFinite(), "candidates are finite");
      require(candidate.matched_share >= 0.0 && candidate.matched_share <= 1.0, "shares are 0 to 1");
    }
  });
}

}  // namespace
}  // namespace saw_ndt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static saw_ndt::FuzzedFile file("fuzzed.map");
  std::string repaired(reinterpret_cast<const char*>(data), size);
  saw_ndt::repairLocalizationMapChecksums(repaired);
  saw_ndt::tryMap(file, reinterpret_cast<const std::uint8_t*>(repaired.data()), size);
  file.tryReading(data, size,
                  [](const std::filesystem::path& path) { saw_ndt::LocalizationMap(path.string()).target(1); });
  return 0;
}
