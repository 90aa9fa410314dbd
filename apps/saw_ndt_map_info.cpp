#include <pcl/conversions.h>

#include <filesystem>
#include <iostream>

#include "app_options.h"
#include "picture_file.h"
#include "report/localization_map_summary.h"
#include "report/map_overview.h"
#include "report/map_summary.h"
#include "report/voxel_cloud.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/io/point_cloud_file.h"
#include "saw_ndt/map/map_update.h"

namespace {

constexpr char kDescription[] =
    "Tells what a map file holds: where it lies, its extent and the area that it covers, how many voxels, points and "
    "labels, how its tiles and bytes are spent, how it was made, and how its voxels are shaped and weighted by the "
    "default confidences. Voxels are those that have a distribution, of 6 points or more. Of a localization map of "
    "saw_ndt_map_pack it tells levels, tiles and bytes, and the methods that it serves.";

void drawOverview(const saw_ndt::WeightedVoxelMap& map, const std::string& map_file, const std::string& colour_name,
                  const std::string& picture_file) {
  using Colour = saw_ndt::OverviewColour;
  Colour colour = map.labelled() ? Colour::LABEL : Colour::HEIGHT;
  for (const Colour named : {Colour::LABEL, Colour::CLASS, Colour::WEIGHT, Colour::HEIGHT}) {
    if (toString(named) == colour_name) colour = named;
  }
  if (colour == Colour::LABEL && !map.labelled()) {
    throw saw_ndt::Error(map_file, "", "has no labels: -colour is class, weight or height");
  }
  const std::string title = std::filesystem::path(map_file).filename().string() + ": " + toString(colour) +
                            " of the topmost voxel, from above";
  saw_ndt::drawPng(saw_ndt::overviewPicture(saw_ndt::overviewVoxels(map), map.resolution(), colour, title),
                   picture_file);
}

}  // namespace

int main(int argc, char** argv) {
  std::string map_file, pcd_file, picture_file, colour = "auto";
  bool as_json = false;
  saw_ndt::AppOptions app("saw_ndt_map_info", kDescription);
  app.addPositional("MAP", &map_file, "map file");
  app.addFlag("json", &as_json, "print one JSON object");
  app.addOption("pcd", &pcd_file, "OUT.pcd",
                "write the mean of every voxel for pcl_viewer: x y z, label (its most frequent one), structure_class "
                "(1 linear, 2 planar, 3 volumetric) and weight");
  app.addOption("picture", &picture_file, "OUT.png", "draw the map from above; needs gnuplot");
  app.addChoice("colour", &colour, {"auto", "label", "class", "weight", "height"},
                "of the topmost voxel at every place of the picture; auto: label, of a map without labels height");

  return saw_ndt::runApp(argc, argv, app, [&] {
    if (picture_file.empty() && app.isGiven("colour")) throw saw_ndt::UsageError("-colour goes with -picture");
    saw_ndt::requireDrawable(picture_file);
    if (saw_ndt::LocalizationMap::isOne(map_file)) {
      if (!pcd_file.empty() || !picture_file.empty()) {
        throw saw_ndt::Error(map_file, "",
                             "is a localization map: -pcd and -picture show the statistics map it was packed from");
      }
      const auto packed = saw_ndt::summarize(saw_ndt::LocalizationMap(map_file));
      std::cout << (as_json ? saw_ndt::toJsonText(packed) : saw_ndt::toText(packed));
      return;
    }
    const saw_ndt::WeightedVoxelMap map = saw_ndt::WeightedVoxelMap::load(map_file);
    if (!pcd_file.empty()) {
      pcl::PCLPointCloud2 voxels;
      pcl::toPCLPointCloud2(saw_ndt::voxelCloud(map), voxels);
      saw_ndt::writePcd(pcd_file, voxels);
    }
    if (!picture_file.empty()) drawOverview(map, map_file, colour, picture_file);
    saw_ndt::MapSummary summary = saw_ndt::summarize(map);
    summary.file_bytes = std::filesystem::file_size(map_file);
    summary.dead_bytes = saw_ndt::deadBytesOfMapFile(map_file);
    std::cout << (as_json ? saw_ndt::toJsonText(summary) : saw_ndt::toText(summary));
  });
}
