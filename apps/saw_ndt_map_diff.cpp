#include <pcl/conversions.h>

#include <iostream>
#include <stdexcept>

#include "app_options.h"
#include "common/atomic_output.h"
#include "picture_file.h"
#include "report/map_diff_report.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/io/point_cloud_file.h"

namespace {

constexpr char kDescription[] =
    "Tells what has changed between two maps of one place, in one map frame: which voxels of A have vanished, which of "
    "B have appeared, and which flat ones have moved along their normal, by a voxel at most. Something may have "
    "vanished or appeared only where the other map has looked: it has points in the voxel or up to 2 m below it "
    "(further "
    "below, where something within 8 m is as high), and so many around that the voxel would be there; other voxels "
    "are not covered. Labels "
    "take no part. Voxels of one change that touch each other are a group; the largest are listed, -json has them all. "
    "Gaps are the distances of flat voxels that both maps have, along their normals: far from 0 where a map lies "
    "askew. docs/maps.md has the rules.";

saw_ndt::MapDiff diffOf(const std::string& first_file, const saw_ndt::WeightedVoxelMap& first,
                        const std::string& second_file, const saw_ndt::WeightedVoxelMap& second,
                        const saw_ndt::MapDiffOptions& options, int threads) {
  try {
    return saw_ndt::diffMaps(first, second, options, threads);
  } catch (const std::invalid_argument& error) {
    throw saw_ndt::Error(second_file, "", "cannot be compared with " + first_file + ": " + error.what());
  }
}

void writeCloud(const saw_ndt::AppOptions& app, const std::string& file, const saw_ndt::MapDiff& diff) {
  if (diff.changes.empty()) {
    saw_ndt::warn(app, file + " is not written: nothing has changed, and a PCD file cannot be empty");
    return;
  }
  pcl::PCLPointCloud2 cloud;
  pcl::toPCLPointCloud2(saw_ndt::changedCloud(diff), cloud);
  saw_ndt::writePcd(file, cloud);
}

}  // namespace

int main(int argc, char** argv) {
  std::string first_file, second_file, pcd_file, picture_file;
  saw_ndt::MapDiffOptions options;
  bool as_json = false;
  saw_ndt::AppOptions app("saw_ndt_map_diff", kDescription);
  app.addPositional("A", &first_file, "map file, the earlier one");
  app.addPositional("B", &second_file, "map file, the later one");
  app.addOption("least-points", &options.least_points, "POINTS", "of a voxel that is compared; 3 or more");
  app.addOption("least-scans", &options.least_scans, "SCANS",
                "that met such a voxel, at least; not asked of maps of fewer scans");
  app.addOption("least-share", &options.least_share_of_scans, "SHARE",
                "of the scans that met the most often met voxel around, at least, so that traffic counts less; 0 to 1");
  app.addOption("least-displacement", &options.least_displacement_m, "METRES", "of a surface that has moved");
  app.addOption("least-voxels", &options.least_voxels, "VOXELS", "of a group; smaller ones are left out");
  app.addFlag("json", &as_json, "print one JSON object");
  app.addOption("pcd", &pcd_file, "OUT.pcd",
                "write the mean of every changed voxel for pcl_viewer: x y z, label, change (1 appeared, 2 vanished, 3 "
                "moved), map (1 A, 2 B) and displacement (m)");
  app.addOption("picture", &picture_file, "OUT.png", "draw the changes from above; needs gnuplot");

  return saw_ndt::runApp(argc, argv, app, [&] {
    saw_ndt::checkedUsage([&] { options.check(); });
    saw_ndt::requireDrawable(picture_file);
    if (!pcd_file.empty()) {
      const saw_ndt::internal::AtomicOutput probe(pcd_file);
    }
    const saw_ndt::WeightedVoxelMap first = saw_ndt::WeightedVoxelMap::load(first_file);
    const saw_ndt::WeightedVoxelMap second = saw_ndt::WeightedVoxelMap::load(second_file);
    const saw_ndt::MapDiff diff = diffOf(first_file, first, second_file, second, options, app.threads());
    if (diff.first.compared == diff.first.not_covered && diff.second.compared == diff.second.not_covered) {
      saw_ndt::warn(app, first_file + " and " + second_file + " have no place in common: nothing could be compared");
    }
    if (!pcd_file.empty()) writeCloud(app, pcd_file, diff);
    if (!picture_file.empty()) saw_ndt::drawPng(saw_ndt::mapDiffPicture(diff, first, second), picture_file);
    std::cout << (as_json ? saw_ndt::toJsonText(diff) : saw_ndt::toText(diff));
  });
}
