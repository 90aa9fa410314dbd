#include <iostream>

#include "app_options.h"
#include "common/atomic_output.h"
#include "saw_ndt/map/map_merge.h"

namespace {

constexpr char kDescription[] =
    "Merges maps of the same resolution and segmentation into the one of all their scans: the same bytes as "
    "saw_ndt_build_map writes for these scans at once, in whatever order the maps are given. The maps of -shard jobs "
    "become the map of the whole drive so, and those of several drives, in one map frame, the map of a town.";

}  // namespace

int main(int argc, char** argv) {
  std::string merged_file;
  std::vector<std::string> map_files;
  saw_ndt::AppOptions app("saw_ndt_map_merge", kDescription);
  app.addPositional("OUT", &merged_file, "map file to write; may be one of those that are merged");
  app.addPositionalList("MAP", &map_files, "map files, each once");

  return saw_ndt::runApp(argc, argv, app, [&] {
    // Found out before the long work: whether the map can be written. This leaves nothing behind.
    { const saw_ndt::internal::AtomicOutput probe(merged_file); }
    const saw_ndt::WeightedVoxelMap map = saw_ndt::mergeMapFiles(map_files);
    map.save(merged_file);
    std::cout << merged_file << ": " << map.voxelCount({}, app.threads()) << " voxels of " << map.resolution()
              << " m from " << map.origin().point_count << " points of " << map.origin().scan_count << " scans of "
              << map_files.size() << " maps\n";
  });
}
