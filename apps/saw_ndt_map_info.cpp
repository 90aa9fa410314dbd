#include <iostream>

#include "app_options.h"
#include "saw_ndt/evaluation/map_summary.h"
#include "saw_ndt/io/point_cloud_file.h"

int main(int argc, char** argv) {
  std::string map_file, pcd_file;
  bool as_json = false;
  saw_ndt::AppOptions app("saw_ndt_map_info",
                          "Tells what a map file holds: where it lies, how many voxels, points and labels, and how its "
                          "voxels are shaped and weighted. -pcd writes the voxels for pcl_viewer.");
  app.addPositional("MAP", &map_file, "map file");
  app.addFlag("json", &as_json, "print one JSON object");
  app.addOption("pcd", &pcd_file, "OUT.pcd",
                "write the mean of every voxel that has a distribution: x y z, label (most frequent), structure_class "
                "(1 linear, 2 planar, 3 volumetric), intensity (weight)");

  return saw_ndt::runApp(argc, argv, app, [&] {
    const saw_ndt::WeightedVoxelMap map = saw_ndt::WeightedVoxelMap::load(map_file);
    const saw_ndt::MapSummary summary = saw_ndt::summarize(map);
    std::cout << (as_json ? saw_ndt::toJsonText(summary) : saw_ndt::toText(summary));
    if (!pcd_file.empty()) saw_ndt::writePcd(pcd_file, saw_ndt::voxelCloud(map));
  });
}
