// Map files, as they are and with checksums that hold.
#include <vector>

#include "fuzzed_file.h"
#include "map_checksums.h"
#include "saw_ndt/map/map_crop.h"
#include "saw_ndt/map/map_merge.h"
#include "saw_ndt/map/map_update.h"
#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/map/weighted_voxel_map.h"

namespace saw_ndt {
namespace {

void requireEqual(const WeightedVoxelMap& a, const WeightedVoxelMap& b) {
  require(a.entries().size() == b.entries().size(), "a map that is saved has the same entries");
  for (std::size_t i = 0; i < a.entries().size(); ++i) {
    const LabelledVoxelSums &x = a.entries()[i], &y = b.entries()[i];
    require(x.voxel == y.voxel && x.label == y.label && x.sums.count == y.sums.count && x.sums.sum == y.sums.sum &&
                x.sums.product == y.sums.product,
            "a map that is saved is the same");
  }
}

void requireSound(const WeightedVoxelMap& map) {
  for (const VoxelStatistics& voxel : map.statistics({}, 1)) {
    require(voxel.mean_from_centre.allFinite() && voxel.covariance.allFinite() && voxel.inverse_covariance.allFinite(),
            "statistics are finite");
    require(voxel.weight >= 0.0 && voxel.weight <= 1.25, "weights are as they are defined");
  }
  for (const Eigen::Vector3d& mean : NdtTarget(map, {}, 1).means()) require(mean.allFinite(), "means are finite");
}

void tryMap(FuzzedFile& file, const std::uint8_t* data, std::size_t size) {
  static const TemporaryFolder folder;
  const std::string other = folder.path() / file.path().filename();
  file.tryReading(data, size, [&](const std::filesystem::path& path) {
    const WeightedVoxelMap map = WeightedVoxelMap::load(path.string());
    requireSound(map);
    map.save(other);
    requireEqual(map, WeightedVoxelMap::load(other));
  });
  file.tryReading(data, size, [](const std::filesystem::path& path) {
    WeightedVoxelMap::load(path.string(), boxRegion({-3, -3, -3}, {3, 3, 3}), 1);
  });
  file.tryReading(data, size, [](const std::filesystem::path& path) { NdtTarget::load(path.string(), {}, 1); });
  file.tryReading(data, size, [](const std::filesystem::path& path) { mergeMapFiles({path.string()}, 1); });
  file.tryReading(data, size, [](const std::filesystem::path& path) { deadBytesOfMapFile(path.string()); });
}

}  // namespace
}  // namespace saw_ndt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static saw_ndt::FuzzedFile file("fuzzed.map");
  std::string repaired(reinterpret_cast<const char*>(data), size);
  saw_ndt::repairMapChecksums(repaired);
  saw_ndt::tryMap(file, reinterpret_cast<const std::uint8_t*>(repaired.data()), size);
  file.tryReading(data, size,
                  [](const std::filesystem::path& path) { saw_ndt::WeightedVoxelMap::load(path.string()); });
  return 0;
}
