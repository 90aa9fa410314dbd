// Localizes in cities that repeat the localization map of a drive, and measures whether that takes time or memory that
// grows with the city.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <limits>

#include "app_options.h"
#include "common/stopwatch.h"
#include "map/localization_map_file.h"
#include "map/localization_map_writer.h"
#include "process_cost.h"
#include "saw_ndt/drives/recording.h"
#include "saw_ndt/localization/localizer.h"

namespace {

namespace fs = std::filesystem;
using saw_ndt::internal::kLocalizationTile_m;
using saw_ndt::internal::LocalizationMapFile;
using saw_ndt::internal::LocalizationTilePlace;
using saw_ndt::internal::PackedTile;

constexpr char kDescription[] =
    "Writes into FOLDER the localization map of a city, in which the tiles of MAP, that of a drive, are repeated side "
    "by side until there are so many kilometres of streets. Localizes the first scans of SEQUENCE, another drive of "
    "the "
    "same place, in copies of the drive spread over the city, and prints a line of a table: bytes, time to open it, "
    "time of a first pose (the tiles included) and of later ones, waits, the greatest error, and the peak memory of a "
    "process that does all of it, with the file in the page cache and out of it. The file is removed in the end.";

// The tiles of a map, side by side in squares of a chessboard.
class City {
 public:
  City(const LocalizationMapFile& drive, std::uint64_t copies) : drive_(drive), copies_(copies) {
    const Eigen::Vector2d extent = (drive.greatest() - drive.least()) / kLocalizationTile_m;
    step_ = extent.array().round().cast<int>();
    columns_ = static_cast<std::uint64_t>(std::ceil(std::sqrt(static_cast<double>(copies))));
  }

  /// How far a copy lies from the drive (tiles).
  Eigen::Vector2i offsetOf(std::uint64_t copy) const {
    return {static_cast<int>(copy % columns_) * step_.x(), static_cast<int>(copy / columns_) * step_.y()};
  }

  void write(const std::string& path) const {
    saw_ndt::MapOrigin origin = drive_.origin();
    saw_ndt::internal::LocalizationMapWriter writer(path, origin, drive_.weighting());
    for (std::uint64_t copy = 0; copy < copies_; ++copy) {
      for (std::size_t i = 0; i < drive_.tileCount(); ++i) {
        const LocalizationTilePlace place = drive_.tile(i);
        PackedTile tile;
        tile.at = {place.at.x + offsetOf(copy).x(), place.at.y + offsetOf(copy).y()};
        tile.cells = drive_.cells(place);
        tile.table = drive_.searchTable(place);
        tile.voxel_count = place.voxel_count;
        writer.add(tile);
      }
    }
    writer.finish();
  }

 private:
  const LocalizationMapFile& drive_;
  std::uint64_t copies_;
  std::uint64_t columns_ = 1;
  Eigen::Vector2i step_;
};

struct Arguments {
  std::string map_file, sequence, folder, method = "weighted";
  std::vector<double> streets_km{10.0};
  double drive_km = 1.0;
  int places = 10, scans = 20;
};

// Localizes in copies of the drive; prints all of the line but the memory.
void localize(const Arguments& arguments, const City& city, std::uint64_t copies, const std::string& city_file,
              int threads) {
  const std::unique_ptr<saw_ndt::Recording> recording = saw_ndt::openRecording(arguments.sequence);
  saw_ndt::LocalizerOptions options;
  options.method = saw_ndt::LocalizationMethod::named(arguments.method);
  options.alignment.threads = threads;
  const saw_ndt::internal::Stopwatch opening;
  const saw_ndt::LocalizationMap map(city_file);
  options.segmentation = map.origin().segmentation.value_or(options.segmentation);
  const double open_ms = opening.milliseconds();
  double first_ms = 0.0, later_ms = 0.0, error_m = 0.0, wait_ms = 0.0;
  std::size_t accepted = 0, waits = 0;
  for (int place = 0; place < arguments.places; ++place) {
    const std::uint64_t copy = arguments.places == 1 ? 0
                                                     : (copies - 1) * static_cast<std::uint64_t>(place) /
                                                           static_cast<std::uint64_t>(arguments.places - 1);
    Eigen::Isometry3d T_map_drive = Eigen::Isometry3d::Identity();
    T_map_drive.translation().head<2>() = kLocalizationTile_m * city.offsetOf(copy).cast<double>();
    saw_ndt::Localizer localizer(saw_ndt::TiledTarget(map), options);
    std::vector<int> numbers;
    for (int scan = 0; scan < arguments.scans; ++scan) numbers.push_back(scan);
    const std::unique_ptr<saw_ndt::ScanSource> scans = recording->scans(numbers);
    saw_ndt::RecordedScan scan;
    for (int i = 0; scans->next(scan); ++i) {
      const Eigen::Isometry3d T_map_base = T_map_drive * scan.T_map_lidar.value();
      if (i == 0) localizer.setInitialPose(T_map_base);
      const saw_ndt::LocalizationResult result = localizer.localize(viewOf(scan), scan.stamp_s);
      (i == 0 ? first_ms : later_ms) = std::max(i == 0 ? first_ms : later_ms, result.times.total_ms);
      if (!result.accepted()) continue;
      ++accepted;
      error_m = std::max(error_m, (result.T_map_base.translation() - T_map_base.translation()).norm());
    }
    waits += localizer.tileLoads()->waits;
    wait_ms = std::max(wait_ms, localizer.tileLoads()->longest_wait_ms);
  }
  std::cout << fs::file_size(city_file) << " | " << map.tileCount() << " | " << std::fixed << std::setprecision(2)
            << open_ms << " | " << std::setprecision(0) << first_ms << " | " << later_ms << " | " << waits << " | "
            << std::setprecision(1) << wait_ms << " | " << accepted << " of " << arguments.places * arguments.scans
            << " | " << std::setprecision(4) << error_m << " | " << std::flush;
}

void measure(const Arguments& arguments, double km, int threads) {
  const std::string city_file = (fs::path(arguments.folder) / "city.loc").string();
  const LocalizationMapFile drive(arguments.map_file);
  const auto copies = static_cast<std::uint64_t>(std::max(1.0, std::round(km / arguments.drive_km)));
  const City city(drive, copies);
  const saw_ndt::ProcessCost writing = saw_ndt::costOf([&] { city.write(city_file); });
  std::cerr << km << " km: written in " << writing.seconds << " s\n";
  for (const bool in_cache : {false, true}) {
    if (!in_cache) saw_ndt::leavePageCache(city_file);
    std::cout << "| " << std::defaultfloat << km << (in_cache ? "" : ", file not in memory") << " | ";
    const saw_ndt::ProcessCost cost = saw_ndt::costOf([&] { localize(arguments, city, copies, city_file, threads); });
    std::cout << std::fixed << std::setprecision(0) << cost.peak_mb << " |\n" << std::flush;
  }
  fs::remove(city_file);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  saw_ndt::AppOptions app("city_localization", kDescription);
  app.addPositional("MAP", &arguments.map_file, "localization map of a drive");
  app.addPositional("SEQUENCE", &arguments.sequence, "another drive of the place with its reference poses");
  app.addPositional("FOLDER", &arguments.folder, "folder for the cities");
  app.addOption("drive-km", &arguments.drive_km, "KM", "length of the streets in MAP (kilometres)");
  app.addOption("km", &arguments.streets_km, "KM,KM,...", "lengths of the streets of cities (kilometres)");
  app.addOption("places", &arguments.places, "N", "in which is localized");
  app.addOption("scans", &arguments.scans, "N", "at each");
  app.addChoice("method", &arguments.method, saw_ndt::LocalizationMethod::names(), "that MAP was packed for");
  return saw_ndt::runApp(argc, argv, app, [&] {
    std::cout
        << "| km of streets | bytes | tiles | open ms | first pose ms | later ms, at most | waits | longest wait ms | "
           "accepted | greatest error m | peak MB |\n|---|---|---|---|---|---|---|---|---|---|---|\n";
    for (const double km : arguments.streets_km) measure(arguments, km, app.threads());
  });
}
