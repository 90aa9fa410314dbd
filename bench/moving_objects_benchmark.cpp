// Tells what removing what moved takes from a map, by the labels of simulated drives, and what that is worth to a
// localizer.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>

#include "app_options.h"
#include "common/stopwatch.h"
#include "moving_truth.h"
#include "report/gnuplot.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/drives/drive_localization.h"
#include "saw_ndt/drives/moved_removal.h"
#include "saw_ndt/drives/scan_selection.h"
#include "saw_ndt/evaluation/metrics.h"
#include "segmentation_options.h"

namespace {

using saw_ndt::RemovalScore;

constexpr char kDescription[] =
    "Builds the map of each SEQUENCE, removes what moved, and prints, where there are labels of SemanticKITTI, which "
    "share of the points of what moves and of everything else has gone, and the seconds of both passes over the scans. "
    "With -localize it prints the error of localizing another drive in the whole map and in what remains.";

struct Arguments {
  std::vector<std::string> sequences, localize, methods{"classical", "weighted"}, shares{"0.3"};
  std::string map_scans = ":", scans = ":", pictures;
  double skip_s = 3.0, resolution_m = saw_ndt::DriveMapOptions().resolution_m, max_range_m = 60.0;
  bool classical = false;
  int threads = 0;
  saw_ndt::SegmentationArguments segmentation;
};

/// A map, and what remains of it.
struct CleanedMap {
  saw_ndt::WeightedVoxelMap whole, remaining;
};

void printScores(const std::string& name, const std::string& share, const RemovalScore& score, double building_s,
                 double removing_s) {
  std::printf("| %s | %s |", name.c_str(), share.c_str());
  for (std::size_t kind = 0; kind < saw_ndt::kPointKinds; ++kind) {
    if (score.points[kind] == 0) {
      std::printf(" – |");
    } else {
      std::printf(" %.3f |", 100.0 * score.removedShare(static_cast<saw_ndt::PointKind>(kind)));
    }
  }
  std::printf(" %.3f | %.1f | %.1f | %.2f | %.2f |\n", 100.0 * score.removedStaticShare(), 100.0 * score.precision(),
              100.0 * static_cast<double>(score.removed_moving_voxels) /
                  static_cast<double>(std::max<std::size_t>(score.moving_voxels, 1)),
              building_s, removing_s);
  std::fflush(stdout);
}

// What remains of a map and what was removed, seen from above.
void draw(const std::string& name, const CleanedMap& maps, const std::string& folder) {
  std::vector<std::vector<double>> remaining(2), removed(2);
  auto kept = maps.remaining.entries().begin();
  for (const saw_ndt::LabelledVoxelSums& entry : maps.whole.entries()) {
    const bool stays =
        kept != maps.remaining.entries().end() && kept->voxel == entry.voxel && kept->label == entry.label;
    if (stays) ++kept;
    if (entry.label == saw_ndt::StructuralLabel::GROUND) continue;
    std::vector<std::vector<double>>& columns = stays ? remaining : removed;
    for (int axis = 0; axis < 2; ++axis) {
      columns[static_cast<std::size_t>(axis)].push_back((entry.voxel[axis] + 0.5) * maps.whole.resolution());
    }
  }
  if (removed.front().empty() || remaining.front().empty()) return;
  saw_ndt::GnuplotPicture picture;
  picture.name = "moved_" + name;
  const auto extent = [](const std::vector<double>& values) {
    const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
    return *greatest - *least;
  };
  picture.width_px = 900;
  picture.height_px =
      static_cast<int>(std::clamp(820.0 * extent(remaining[1]) / extent(remaining[0]), 200.0, 900.0)) + 120;
  picture.many_points = true;
  picture.data = saw_ndt::gnuplotData("$remaining", remaining) + saw_ndt::gnuplotData("$removed", removed);
  picture.commands =
      "set size ratio -1\nset xlabel 'x (m)'\nset ylabel 'y (m)'\nset key outside top center horizontal\n"
      "plot $remaining with dots linecolor rgb '#909090' title 'remains, without ground', "
      "$removed with points pointtype 7 pointsize 0.25 linecolor rgb '#d62728' title 'removed'\n";
  saw_ndt::drawPicture(picture, folder);
}

void printHeader() {
  std::cout << "Removed, % of the points of each kind; precision, % of the removed points; seconds:\n\n| drive | "
               "share |";
  for (const char* const kind : saw_ndt::pointKindNames()) std::cout << ' ' << kind << " |";
  std::cout << " all but moving | precision | moving voxels removed | building s | removing s "
               "|\n|---|---|";
  for (std::size_t i = 0; i < saw_ndt::kPointKinds + 5; ++i) std::cout << "---|";
  std::cout << std::endl;
}

// Prints a row for each share; returns the map and what remains of it with the first one.
CleanedMap cleanedMap(const std::string& folder, Arguments& arguments) {
  const saw_ndt::KittiSequence sequence(folder);
  const std::vector<int> scans = saw_ndt::parseScanSelection(arguments.map_scans, sequence.scanCount());
  saw_ndt::DriveMapOptions options;
  options.resolution_m = arguments.resolution_m;
  options.threads = arguments.threads;
  if (arguments.classical) {
    options.segmentation.reset();
  } else {
    options.segmentation = arguments.segmentation.learnedFrom(saw_ndt::firstScans(*sequence.scans(scans)));
  }
  const saw_ndt::internal::Stopwatch building;
  CleanedMap result;
  result.whole = saw_ndt::buildDriveMap(*sequence.scans(scans), options).build();
  const double building_s = 1e-3 * building.milliseconds();
  std::optional<saw_ndt::MovingTruth> truth;
  if (std::filesystem::exists(sequence.labelPath(scans.front()))) {
    truth.emplace(sequence, scans, options, result.whole);
  }
  for (const std::string& share : arguments.shares) {
    saw_ndt::MovedVoxelOptions moved_options;
    moved_options.max_hit_share = std::stod(share);
    moved_options.max_range_m = arguments.max_range_m;
    saw_ndt::MovedVoxels moved(result.whole, moved_options);
    const saw_ndt::internal::Stopwatch removing;
    saw_ndt::addScans(*sequence.scans(scans), options, moved);
    const saw_ndt::WeightedVoxelMap remaining = moved.remaining();
    const double removing_s = 1e-3 * removing.milliseconds();
    if (truth) {
      printScores(folder, share, truth->score(result.whole, remaining), building_s, removing_s);
    } else {
      std::printf("%s, share %s: %llu of %llu points removed, building %.2f s, removing %.2f s\n", folder.c_str(),
                  share.c_str(),
                  static_cast<unsigned long long>(result.whole.origin().point_count - remaining.origin().point_count),
                  static_cast<unsigned long long>(result.whole.origin().point_count), building_s, removing_s);
    }
    if (result.remaining.entries().empty()) result.remaining = remaining;
  }
  return result;
}

std::string localized(const saw_ndt::WeightedVoxelMap& map, const std::string& folder, const std::string& method,
                      const Arguments& arguments) {
  const saw_ndt::KittiSequence sequence(folder);
  const std::vector<int> scans = saw_ndt::parseScanSelection(arguments.scans, sequence.scanCount());
  saw_ndt::LocalizerOptions options;
  options.method = saw_ndt::LocalizationMethod::named(method);
  options.alignment.threads = arguments.threads;
  if (map.origin().segmentation) options.segmentation = *map.origin().segmentation;
  saw_ndt::Localizer localizer(map, options);
  localizer.setInitialPose(sequence.referencePose(scans.front()).value());
  const saw_ndt::DriveLocalization run = saw_ndt::localizeDrive(localizer, *sequence.scans(scans));
  std::vector<saw_ndt::PosePair> pairs;
  std::size_t accepted = 0;
  for (std::size_t i = 0; i < run.results.size(); ++i) {
    accepted += run.results[i].accepted() ? 1 : 0;
    if (run.results[i].stamp_s - run.results.front().stamp_s < arguments.skip_s) continue;
    pairs.push_back({run.results[i].stamp_s, run.T_map_lidar_reference[i].value(), run.results[i].T_map_base});
  }
  const saw_ndt::TrajectoryMetrics metrics = saw_ndt::evaluatePosePairs(pairs);
  char text[100];
  std::snprintf(text, sizeof text, "%.2f / %.4f / %.0f", 1e3 * metrics.ate_rmse_m, metrics.yaw_mae_deg,
                100.0 * static_cast<double>(accepted) / static_cast<double>(run.results.size()));
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  saw_ndt::AppOptions app("moving_objects_benchmark", kDescription);
  app.addPositionalList("SEQUENCE", &arguments.sequences, "folders in KITTI layout, with reference poses");
  app.addOption("max-hit-shares", &arguments.shares, "SHARE,...",
                "see saw_ndt_build_map; the first one is localized in");
  app.addOption("max-range", &arguments.max_range_m, "METRES", "how far scans are trusted to see through");
  app.addOption("resolution", &arguments.resolution_m, "METRES", "edge of the voxels");
  app.addOption("map-scans", &arguments.map_scans, "SLICE", "scans of the maps, first:last:step as in Python");
  app.addFlag("classical", &arguments.classical, "maps without labels");
  app.addOption("localize", &arguments.localize, "FOLDER,...", "for each SEQUENCE the drive to localize in its map");
  app.addOption("scans", &arguments.scans, "SLICE", "scans to localize");
  app.addOption("methods", &arguments.methods, "NAME,...", "of localization");
  app.addOption("pictures", &arguments.pictures, "FOLDER", "draw what goes and what remains there, by gnuplot");
  app.addOption("skip", &arguments.skip_s, "SECONDS", "time at the start of a drive that the errors leave out");
  arguments.segmentation.addTo(app);
  return saw_ndt::runApp(argc, argv, app, [&] {
    arguments.threads = app.threads();
    if (!arguments.localize.empty() && arguments.localize.size() != arguments.sequences.size()) {
      throw saw_ndt::UsageError("option -localize: as many folders are needed as SEQUENCE has");
    }
    printHeader();
    std::vector<std::string> rows;
    for (std::size_t i = 0; i < arguments.sequences.size(); ++i) {
      const CleanedMap maps = cleanedMap(arguments.sequences[i], arguments);
      if (!arguments.pictures.empty()) {
        draw(std::to_string(i + 1) + "_" + saw_ndt::KittiSequence(arguments.sequences[i]).name(), maps,
             arguments.pictures);
      }
      if (arguments.localize.empty()) continue;
      for (const std::string& method : arguments.methods) {
        rows.push_back("| " + arguments.localize[i] + " | " + method + " | " +
                       localized(maps.whole, arguments.localize[i], method, arguments) + " | " +
                       localized(maps.remaining, arguments.localize[i], method, arguments) + " |");
      }
    }
    if (rows.empty()) return;
    std::cout << "\nATE mm / yaw MAE deg / accepted %:\n\n| drive | method | in the whole map | in what remains "
                 "|\n|---|---|---|---|\n";
    for (const std::string& row : rows) std::cout << row << '\n';
  });
}
