// Localizes scans each by itself, with no pose to start from, and prints how many were found and how long that took.

#include <iostream>
#include <map>

#include "app_options.h"
#include "common/stopwatch.h"
#include "evaluation/statistics.h"
#include "pose_argument.h"
#include "progress_bar.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/drives/scan_selection.h"
#include "saw_ndt/localization/localizer.h"

namespace {

constexpr char kDescription[] =
    "Localizes scans of SEQUENCE in MAP, each by itself, with no pose to start from, and prints what the index takes "
    "and a line of a table: how "
    "many were found, how many were accepted wrongly (off by more than 0.5 m or 2 degrees), why the others were "
    "rejected, and the time from the scan to the answer. With -copy-at the map is there twice: then no scan tells "
    "where it was taken, and none must be accepted.";

constexpr double kWrong_m = 0.5;
constexpr double kWrong_deg = 2.0;

// The map, and beside it the same once more.
saw_ndt::WeightedVoxelMap withCopy(const saw_ndt::WeightedVoxelMap& map, const std::vector<double>& offset_m) {
  saw_ndt::VoxelCoordinate offset;
  for (int axis = 0; axis < 3; ++axis) {
    offset[axis] = static_cast<int>(std::lround(offset_m[static_cast<std::size_t>(axis)] / map.resolution()));
  }
  std::vector<saw_ndt::LabelledVoxelSums> entries = map.entries();
  for (const saw_ndt::LabelledVoxelSums& entry : map.entries()) {
    entries.push_back(entry);
    entries.back().voxel += offset;
  }
  return {map.origin(), std::move(entries)};
}

}  // namespace

int main(int argc, char** argv) {
  std::string sequence_folder, map_file, poses_file, scans = ":", method = "weighted";
  std::vector<double> copy_offset_m(3, 0.0);
  bool verbose = false;
  saw_ndt::AppOptions app("search_benchmark", kDescription);
  app.addPositional("SEQUENCE", &sequence_folder, "folder in KITTI layout");
  app.addPositional("MAP", &map_file, "map file of saw_ndt_build_map");
  app.addOption("scans", &scans, "SLICE", "scans, first:last:step as in Python");
  app.addOption("poses", &poses_file, "FILE", "reference poses, KITTI format (default: as saw_ndt_localize)");
  app.addChoice("method", &method, saw_ndt::LocalizationMethod::names(), "of localization");
  app.addOption("copy-at", &copy_offset_m, "X,Y,Z", "where the map is a second time (metres); all zero: nowhere");
  app.addFlag("verbose", &verbose, "also tell of each scan that was not found");
  return saw_ndt::runApp(argc, argv, app, [&] {
    saw_ndt::LocalizerOptions options;
    options.method = saw_ndt::LocalizationMethod::named(method);
    options.alignment.threads = app.threads();
    const saw_ndt::KittiSequence sequence(sequence_folder, poses_file);
    const std::vector<int> selected =
        saw_ndt::checkedUsage([&] { return saw_ndt::parseScanSelection(scans, sequence.scanCount()); });
    const saw_ndt::NdtTarget target =
        app.isGiven("copy-at") ? saw_ndt::NdtTarget(withCopy(saw_ndt::WeightedVoxelMap::load(map_file), copy_offset_m),
                                                    options.method.voxels, app.threads())
                               : saw_ndt::NdtTarget::load(map_file, options.method.voxels, app.threads());
    const saw_ndt::internal::Stopwatch stopwatch;
    const saw_ndt::GlobalSearch search(target);
    std::cout << "The index takes " << static_cast<double>(search.memoryUsage()) / 1e6 << " MB, and "
              << stopwatch.milliseconds() << " ms to make.\n\n";
    saw_ndt::Localizer localizer(target, options);

    std::size_t found = 0, wrong = 0;
    std::map<std::string, std::size_t> rejected;
    std::vector<double> total_ms;
    saw_ndt::ProgressBar progress(selected.size());
    for (const int scan : selected) {
      const std::vector<saw_ndt::LidarPoint> points = sequence.readScan(scan);
      localizer.setUnknownPose();
      const saw_ndt::LocalizationResult result = localizer.localize(saw_ndt::viewOf(points), 0.0);
      total_ms.push_back(result.times.total_ms);
      const saw_ndt::PoseCorrection error =
          saw_ndt::correctionOf(sequence.posesLidar()[static_cast<std::size_t>(scan)], result.T_map_base);
      const bool is_wrong = error.distance_m > kWrong_m || saw_ndt::degreesFromRadians(error.angle_rad) > kWrong_deg;
      if (!result.accepted()) {
        ++rejected[saw_ndt::toString(result.acceptance)];
      } else {
        ++(is_wrong ? wrong : found);
      }
      if (verbose && (!result.accepted() || is_wrong)) {
        std::cerr << "scan " << scan << ": " << saw_ndt::toString(result.acceptance) << ", overlap "
                  << result.alignment.overlap << ", " << error.distance_m << " m off\n";
      }
      progress.step();
    }
    std::cout << "| scans | found | wrongly accepted | rejected | median ms | most ms |\n|---|---|---|---|---|---|\n| "
              << selected.size() << " | " << found << " | " << wrong << " | ";
    for (const auto& [reason, count] : rejected) std::cout << count << ' ' << reason << ' ';
    std::cout << "| " << saw_ndt::internal::median(total_ms) << " | " << saw_ndt::internal::percentile(total_ms, 100.0)
              << " |\n";
  });
}
