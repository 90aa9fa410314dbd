#include <iostream>
#include <locale>
#include <sstream>

#include "app_options.h"
#include "common/atomic_output.h"
#include "saw_ndt/drives/map_import.h"

namespace {

constexpr char kDescription[] =
    "Makes an NDT map of a point cloud map: of a PCD or PLY file of any size, which is read in blocks, of a folder of "
    "tiles with Autoware's pointcloud_map_metadata.yaml, or of all PCD and PLY files of a folder. Points with a field "
    "`label` of 0 (noise), 1 (ground) and 2 (non-ground) make a map for every method of saw_ndt_localize, others one "
    "for the method classical alone. A compressed PCD file is unpacked as a whole, 2 GiB at most.";

std::string textOf(const std::array<double, 3>& position) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(15);
  text << position[0] << ',' << position[1] << ',' << position[2];
  return text.str();
}

saw_ndt::ImportedLabels parseLabels(const std::string& word) {
  if (word == "none") return saw_ndt::ImportedLabels::NONE;
  return word == "heights" ? saw_ndt::ImportedLabels::HEIGHTS : saw_ndt::ImportedLabels::AUTO;
}

void report(const std::string& map_file, const saw_ndt::ImportedMap& imported, const saw_ndt::WeightedVoxelMap& map,
            int threads) {
  std::cout << map_file << ": " << map.voxelCount({}, threads) << " voxels of " << map.resolution() << " m from "
            << map.origin().point_count << " points of " << imported.files << (imported.files == 1 ? " file" : " files")
            << (map.labelled() ? ", labelled" : ", without labels: for the method classical") << '\n';
  if (!imported.why_unlabelled.empty()) std::cout << "labels left aside: " << imported.why_unlabelled << '\n';
  const std::uint64_t too_far =
      imported.points_read - imported.points_not_finite - imported.points_at_zero - map.origin().point_count;
  if (map.origin().point_count < imported.points_read) {
    std::cout << "points passed over: " << imported.points_not_finite << " not finite, " << imported.points_at_zero
              << " at (0, 0, 0), " << too_far << " too far out\n";
  }
  for (const std::string& name : imported.files_beside) {
    std::cout << "left out: " << name << ", which the metadata do not name\n";
  }
  if (imported.origin_m != std::array<double, 3>{}) {
    std::cout << "origin taken off: " << textOf(imported.origin_m)
              << " (the map file tells it: add it to poses in the map for those of the cloud)\n";
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::string cloud, map_file, origin = "auto", labels = "auto";
  saw_ndt::MapImportOptions options;
  saw_ndt::AppOptions app("saw_ndt_map_import", kDescription);
  app.addPositional("CLOUD", &cloud, "PCD or PLY file, or a folder of such");
  app.addPositional("MAP", &map_file, "map file to write");
  app.addOption("resolution", &options.resolution_m, "METRES", "edge of the smallest voxels that methods can match");
  app.addOption("origin", &origin, "X,Y,Z",
                "taken off all coordinates (metres); auto: where they are beyond 100 km, the multiple of 1000 m next "
                "to the first points, which is told");
  app.addChoice("labels", &labels, {"auto", "none", "heights"},
                "where labels come from: the field `label`, nowhere, or how high points lie above the lowest around");

  return saw_ndt::runApp(argc, argv, app, [&] {
    if (origin != "auto") {
      const std::vector<double> numbers = saw_ndt::parseNumbers("origin", origin, 3);
      options.origin_m = {numbers[0], numbers[1], numbers[2]};
    }
    options.labels = parseLabels(labels);
    options.threads = app.threads();
    saw_ndt::checkedUsage([&] { options.check(); });
    // Found out before the long work: whether the map can be written. This leaves nothing behind.
    { const saw_ndt::internal::AtomicOutput probe(map_file); }
    saw_ndt::ImportedMap imported = saw_ndt::importMap(cloud, options);
    const saw_ndt::WeightedVoxelMap map = std::move(imported.builder).build();
    map.save(map_file);
    report(map_file, imported, map, options.threads);
  });
}
