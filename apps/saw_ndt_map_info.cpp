#include <pcl/conversions.h>

#include <iostream>

#include "app_options.h"
#include "report/map_summary.h"
#include "report/voxel_cloud.h"
#include "saw_ndt/io/point_cloud_file.h"
#include "saw_ndt/map/map_update.h"

namespace {

constexpr char kDescription[] =
    "Tells what a map file holds: where it lies, how many voxels, points and labels, how it was made, and how its "
    "voxels are shaped and weighted by the default confidences. Voxels are those that have a distribution, of 6 points "
    "or more.";

}  // namespace

int main(int argc, char** argv) {
  std::string map_file, pcd_file;
  bool as_json = false;
  saw_ndt::AppOptions app("saw_ndt_map_info", kDescription);
  app.addPositional("MAP", &map_file, "map file");
  app.addFlag("json", &as_json, "print one JSON object");
  app.addOption("pcd", &pcd_file, "OUT.pcd",
                "write the mean of every voxel for pcl_viewer: x y z, label (its most frequent one), structure_class "
                "(1 linear, 2 planar, 3 volumetric) and weight");

  return saw_ndt::runApp(argc, argv, app, [&] {
    const saw_ndt::WeightedVoxelMap map = saw_ndt::WeightedVoxelMap::load(map_file);
    if (!pcd_file.empty()) {
      pcl::PCLPointCloud2 voxels;
      pcl::toPCLPointCloud2(saw_ndt::voxelCloud(map), voxels);
      saw_ndt::writePcd(pcd_file, voxels);
    }
    saw_ndt::MapSummary summary = saw_ndt::summarize(map);
    summary.dead_bytes = saw_ndt::deadBytesOfMapFile(map_file);
    std::cout << (as_json ? saw_ndt::toJsonText(summary) : saw_ndt::toText(summary));
  });
}
