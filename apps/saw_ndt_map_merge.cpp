#include <iostream>

#include "app_options.h"
#include "common/atomic_output.h"
#include "saw_ndt/map/map_merge.h"
#include "saw_ndt/map/map_update.h"

namespace {

constexpr char kDescription[] =
    "Merges maps of the same resolution, segmentation and origin into the one of all their scans: the same bytes as "
    "saw_ndt_build_map writes for these scans at once, in whatever order the maps are given. The maps of -shard jobs "
    "become the map of the whole drive so, and those of several drives, in one map frame, the map of a town. Memory "
    "does not grow with the maps. With -update drives are added to a map of any size in place: only the tiles that "
    "they meet are written, behind the others, and whatever happens meanwhile, the file is the old map or the new one.";

void merge(const std::string& merged_file, const std::vector<std::string>& map_files, int threads) {
  // Found out before the long work: whether the map can be written. This leaves nothing behind.
  { const saw_ndt::internal::AtomicOutput probe(merged_file); }
  const saw_ndt::MergedMap map = saw_ndt::mergeMapFiles(map_files, merged_file, threads);
  std::cout << merged_file << ": " << map.voxel_count << " voxels of " << map.origin.resolution_m << " m from "
            << map.origin.point_count << " points of " << map.origin.scan_count << " scans of " << map_files.size()
            << (map_files.size() == 1 ? " map\n" : " maps\n");
  if (map.dead_bytes_left_out != 0) {
    std::cout << "left out: " << map.dead_bytes_left_out << " dead bytes that updates had replaced\n";
  }
}

void update(const std::string& map_file, const std::vector<std::string>& added_files, int threads) {
  const saw_ndt::MapUpdate map = saw_ndt::updateMapFile(map_file, added_files, threads);
  std::cout << map_file << ": " << map.origin.point_count << " points of " << map.origin.scan_count << " scans; "
            << map.tiles_met << " tiles updated, " << map.tiles_new << " of them new, by " << map.bytes_appended
            << " bytes\n"
            << map.dead_bytes << " of its " << map.file_bytes
            << " bytes are dead: merging it alone into another file leaves them out\n";
}

}  // namespace

int main(int argc, char** argv) {
  std::string merged_file;
  std::vector<std::string> map_files;
  bool in_place = false;
  saw_ndt::AppOptions app("saw_ndt_map_merge", kDescription);
  app.addPositional("OUT", &merged_file, "map file to write; may be one of those that are merged");
  app.addPositionalList("MAP", &map_files, "map files, each once");
  app.addFlag("update", &in_place, "OUT is a map file: add the maps to it in place");

  return saw_ndt::runApp(argc, argv, app, [&] {
    in_place ? update(merged_file, map_files, app.threads()) : merge(merged_file, map_files, app.threads());
  });
}
