// Writes maps of cities, which repeat a drive's map, and measures what is done with a part of them: whether that takes
// time or memory that grows with the city.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iomanip>
#include <iostream>
#include <map>

#include "app_options.h"
#include "map/map_file.h"
#include "map/map_file_writer.h"
#include "process_cost.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/map/map_crop.h"
#include "saw_ndt/map/map_merge.h"
#include "saw_ndt/map/map_update.h"

namespace {

namespace fs = std::filesystem;
using saw_ndt::internal::MapFileReader;
using saw_ndt::internal::MapTileRecord;

constexpr char kDescription[] =
    "Writes into FOLDER the map file of a city, in which the tiles of MAP, the map of a drive, are repeated side by "
    "side until there are so many kilometres of streets, and prints a table of seconds and peak memory: of opening "
    "it, reading and cropping a square of it, adding the drive to it in place, and merging it into a new file. Each is "
    "a process of its own. First the file's pages are put out of the page cache, then it is done once more. The files "
    "are removed in the end.";

// The tiles of a map, side by side in squares of a chessboard, in map order.
class City {
 public:
  City(const MapFileReader& drive, std::uint64_t copies) : drive_(drive), copies_(copies) {
    least_ = greatest_ = drive.front().tile(0).coordinate;
    for (std::uint64_t i = 0; i < drive.tileCount(); ++i) {
      const MapTileRecord tile = drive.front().tile(i);
      least_ = least_.cwiseMin(tile.coordinate);
      greatest_ = greatest_.cwiseMax(tile.coordinate);
      rows_[tile.coordinate.z()][tile.coordinate.y()].push_back(tile);
    }
    columns_ = static_cast<std::uint64_t>(std::ceil(std::sqrt(static_cast<double>(copies))));
  }

  void write(const std::string& path) const {
    saw_ndt::MapOrigin origin = drive_.origin();
    origin.scan_count *= copies_;
    saw_ndt::internal::MapFileWriter writer(path, origin, copies_ * drive_.tileCount());
    const Eigen::Vector3i step = greatest_ - least_ + Eigen::Vector3i::Ones();
    for (const auto& [z, rows_of_z] : rows_) {
      for (std::uint64_t first = 0; first < copies_; first += columns_) {
        for (const auto& [y, tiles] : rows_of_z) {
          for (std::uint64_t copy = first; copy < std::min(first + columns_, copies_); ++copy) {
            for (MapTileRecord tile : tiles) {
              const char* const bytes = drive_.bytesOf(tile);
              tile.coordinate.x() += static_cast<int>(copy - first) * step.x();
              tile.coordinate.y() += static_cast<int>(first / columns_) * step.y();
              writer.add(tile, bytes);
            }
          }
        }
      }
    }
    writer.commit(origin.point_count * copies_);
  }

  /// The middle of the drive's tiles, in the copy at its own place (m).
  Eigen::Vector3d middle() const {
    const Eigen::Vector3d tiles = 0.5 * (least_ + greatest_ + Eigen::Vector3i::Ones()).cast<double>();
    return tiles * saw_ndt::internal::kTileSize * drive_.origin().resolution_m;
  }

 private:
  const MapFileReader& drive_;
  std::uint64_t copies_, columns_ = 1;
  Eigen::Vector3i least_, greatest_;
  std::map<int, std::map<int, std::vector<MapTileRecord>>> rows_;
};

void printRow(double km, const std::string& what, const saw_ndt::ProcessCost& cost) {
  std::cout << "| " << km << " | " << what << " | " << std::fixed << std::setprecision(3) << cost.seconds << " | "
            << std::setprecision(0) << cost.peak_mb << " |\n"
            << std::defaultfloat << std::setprecision(6) << std::flush;
}

struct CityArguments {
  std::string drive_file, folder;
  std::vector<double> streets_km{10.0};
  double drive_km = 1.0, square_m = 400.0;
  bool merges = false;
};

// Writes a city and measures it.
void measure(const CityArguments& arguments, double km, int threads) {
  const std::string city_file = (fs::path(arguments.folder) / "city.map").string(),
                    part_file = (fs::path(arguments.folder) / "part.map").string();
  Eigen::Vector3d middle_m;
  std::uint64_t tile_count = 0;
  {
    const MapFileReader drive(arguments.drive_file);
    const auto copies = static_cast<std::uint64_t>(std::max(1.0, std::round(km / arguments.drive_km)));
    tile_count = copies * drive.tileCount();
    const City city(drive, copies);
    middle_m = city.middle();
    printRow(km, "write", saw_ndt::costOf([&] { city.write(city_file); }));
  }
  std::cerr << km << " km: " << fs::file_size(city_file) << " bytes, " << tile_count << " tiles\n";
  const Eigen::Vector3d half_m(0.5 * arguments.square_m, 0.5 * arguments.square_m, 1e4);
  const saw_ndt::MapRegion square = saw_ndt::boxRegion(middle_m - half_m, middle_m + half_m);
  const auto printColdAndWarm = [&](const std::string& what, const std::function<void()>& work) {
    saw_ndt::leavePageCache(city_file);
    printRow(km, what + ", file not in memory", saw_ndt::costOf(work));
    printRow(km, what, saw_ndt::costOf(work));
  };
  printColdAndWarm("open", [&] { const MapFileReader reader(city_file); });
  printColdAndWarm("read the square", [&] { saw_ndt::WeightedVoxelMap::load(city_file, square, threads); });
  printColdAndWarm("crop to the square", [&] { saw_ndt::cropMapFile(city_file, square, part_file, threads); });
  // By a drive in the square, and then by the whole one.
  printColdAndWarm("update with the square", [&] { saw_ndt::updateMapFile(city_file, {part_file}, threads); });
  printColdAndWarm("update with the drive",
                   [&] { saw_ndt::updateMapFile(city_file, {arguments.drive_file}, threads); });
  std::cerr << km << " km: " << saw_ndt::deadBytesOfMapFile(city_file) << " dead bytes after four updates\n";
  if (arguments.merges) {
    saw_ndt::leavePageCache(city_file);
    printRow(km, "merge into a new file",
             saw_ndt::costOf([&] { saw_ndt::mergeMapFiles({city_file}, part_file, threads); }));
  }
  fs::remove(city_file);
  fs::remove(part_file);
}

}  // namespace

int main(int argc, char** argv) {
  CityArguments arguments;
  saw_ndt::AppOptions app("city_map", kDescription);
  app.addPositional("MAP", &arguments.drive_file, "map file of a drive");
  app.addPositional("FOLDER", &arguments.folder, "folder for the cities; one of 1000 km has some 25 GB");
  app.addOption("drive-km", &arguments.drive_km, "KM", "length of the streets in MAP (kilometres)");
  app.addOption("km", &arguments.streets_km, "KM,KM,...", "lengths of the streets of cities (kilometres)");
  app.addOption("square", &arguments.square_m, "METRES", "edge of the square, in the middle of MAP");
  app.addFlag("merge", &arguments.merges, "also merge the city into a new file, which takes as much space again");
  return saw_ndt::runApp(argc, argv, app, [&] {
    std::cout << "| km of streets | what | s | peak MB |\n|---|---|---|---|\n";
    for (const double km : arguments.streets_km) measure(arguments, km, app.threads());
  });
}
