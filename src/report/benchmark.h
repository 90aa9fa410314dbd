#pragma once

#include <pcl/point_cloud.h>

#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "report/localization_summary.h"
#include "report/voxel_cloud.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/drives/recording.h"

namespace saw_ndt {

/// The drive whose scans a map is built from: that which is localized, as in the paper, or another one along the same
/// streets.
enum class MapDrive { SAME, OTHER };

/// "same drive", "other drive"
const char* toString(MapDrive drive);
/// "same", "other": for file names and tables of data
const char* shortName(MapDrive drive);

/// The method that is pcl::NormalDistributionsTransform itself; see PclNdt.
constexpr char kPclNdtMethod[] = "pcl-ndt";
/// The methods that a benchmark knows: those of LocalizationMethod and kPclNdtMethod.
std::vector<std::string> benchmarkMethodNames();

struct BenchmarkOptions {
  /// The columns of the paper's Table I, then this project's own.
  std::vector<std::string> methods{"classical", "unweighted-s50", "weighted-s100", "weighted-s50", "weighted"};
  std::vector<MapDrive> drives{MapDrive::SAME};
  std::string map_scans = ":";                           ///< scans of the map, a Python slice of either drive's scans
  std::string scans = ":";                               ///< scans to localize, a Python slice
  double skip_s = 3.0;                                   ///< seconds at the start that the metrics leave out
  double resolution_m = DriveMapOptions().resolution_m;  ///< edge of a voxel of the maps
  LocalizerOptions localizer;  ///< of every method but for `method`; segmentation and threads are the map's, too

  /// Throws std::invalid_argument that names the field and its value.
  void check() const;
};

/// A drive to localize, and the one for its map where MapDrive::OTHER is asked for. Their poses share a frame.
struct BenchmarkDrive {
  std::shared_ptr<const Recording> recording;
  std::shared_ptr<const Recording> other;  ///< null: there is none
};

/// One method on one drive in one map.
struct BenchmarkCell {
  std::string method;
  DriveLocalization run;
  LocalizationSummary summary;  ///< with metrics
};

/// Every method on one drive in one map.
struct BenchmarkRun {
  std::string sequence;  ///< name of the drive
  MapDrive drive = MapDrive::SAME;
  std::size_t map_scans = 0;                  ///< how many the map was built from
  std::vector<Eigen::Isometry3d> T_map_base;  ///< reference pose of the base at every scan localized
  Eigen::Isometry3d T_base_lidar = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_camera_lidar = Eigen::Isometry3d::Identity();
  pcl::PointCloud<VoxelPoint> voxels;  ///< of the map, for pictures
  double skip_s = 0.0;
  double min_likelihood = 0.0;       ///< below which scans are rejected
  std::vector<BenchmarkCell> cells;  ///< one a method
};

/// What a benchmark tells while it works; either may be empty.
struct BenchmarkProgress {
  /// A stage of so many steps begins; it is described by a clause.
  std::function<void(const std::string& description, std::size_t steps)> stage_begins;
  std::function<void()> step_done;  ///< may be called from several threads
};

/// The paper's Table I: every method on every drive, in maps of the same drive, of another one, or both. Methods take
/// turns scan by scan. A map is built once for all methods.
class Benchmark {
 public:
  /// Checks what can be checked before the work.
  /// @throws std::invalid_argument where an option does not hold, two drives have one name, another drive is missing, a
  ///         slice selects nothing, or skip_s leaves nothing
  /// @throws Error where poses, stamps or calibration are missing or damaged
  Benchmark(std::vector<BenchmarkDrive> drives, BenchmarkOptions options);

  /// How many calls of stage_begins there will be.
  std::size_t stageCount() const;
  /// Does the work, drive by drive. @throws Error where a scan is missing or damaged
  std::vector<BenchmarkRun> run(const BenchmarkProgress& progress = {}) const;

 private:
  BenchmarkRun runDrive(const BenchmarkDrive& drive, MapDrive map_drive, const BenchmarkProgress& progress) const;

  std::vector<BenchmarkDrive> drives_;
  BenchmarkOptions options_;
};

}  // namespace saw_ndt
