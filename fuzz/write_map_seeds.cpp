#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "map/map_file_bytes.h"
#include "map_checksums.h"
#include "saw_ndt/localization/map_pack.h"
#include "saw_ndt/map/map_update.h"
#include "saw_ndt/map/weighted_map_builder.h"
#include "seeds.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

/// A few voxels of ground and of a wall from x on.
WeightedMapBuilder smallMap(double x_m, bool labelled) {
  std::vector<LidarPoint> points;
  std::vector<StructuralLabel> labels;
  for (int i = 0; i < 60; ++i) {
    const auto a = static_cast<float>(x_m) + 0.2F * static_cast<float>(i % 10), b = 0.3F * static_cast<float>(i / 10);
    points.push_back({a, b, -1.7F + 0.01F * std::sin(a), 0.5F});
    labels.push_back(StructuralLabel::GROUND);
    points.push_back({a, 2.5F + 0.01F * std::sin(b), b, 0.5F});
    labels.push_back(StructuralLabel::NON_GROUND);
  }
  WeightedMapBuilder builder(1.0, labelled ? std::optional(SegmentationOptions()) : std::nullopt);
  builder.addScan(viewOf(points), labelled ? LabelView(labels) : LabelView(), Eigen::Isometry3d::Identity());
  return builder;
}

/// The content of a file, whose checksums a repair must leave as they are.
std::string contentOf(const std::filesystem::path& path, void (*repair)(std::string& bytes)) {
  std::ostringstream content;
  content << std::ifstream(path, std::ios::binary).rdbuf();
  std::string repaired = content.str();
  repair(repaired);
  if (repaired != content.str()) throw std::logic_error(path.string() + ": its checksums are repaired wrongly");
  return repaired;
}

}  // namespace

void writeMapSeeds(const SeedFolder& seeds) {
  const TemporaryFolder folder;
  const std::string file = folder.path() / "a.map", other = folder.path() / "b.map",
                    packed = folder.path() / "packed.map";
  for (const bool labelled : {false, true}) {
    const std::string kind = labelled ? "labelled" : "unlabelled";
    smallMap(0.0, labelled).save(file);
    seeds.add("map_file", kind, contentOf(file, repairMapChecksums));
    seeds.add("map_file", kind + "_version1", asVersion1(contentOf(file, repairMapChecksums)));
    packMap(file, packed, {});
    seeds.add("localization_map", kind, contentOf(packed, repairLocalizationMapChecksums));
    smallMap(70.0, labelled).save(other);
    updateMapFile(file, {other});
    seeds.add("map_file", kind + "_updated", contentOf(file, repairMapChecksums));
    packMap(file, packed, {});
    seeds.add("localization_map", kind + "_tiles", contentOf(packed, repairLocalizationMapChecksums));
  }
}

}  // namespace saw_ndt
