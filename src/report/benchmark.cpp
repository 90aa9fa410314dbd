#include "report/benchmark.h"

#include <algorithm>
#include <memory>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "report/pcl_ndt.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/drives/scan_selection.h"

namespace saw_ndt {
namespace {

/// The targets of one map, one for each weighting that a method asks for; methods that ask for the same share it.
class MapTargets {
 public:
  explicit MapTargets(WeightedVoxelMap map) : map_(std::move(map)) {}

  NdtTarget with(const VoxelWeighting& weighting) {
    for (const NdtTarget& target : targets_) {
      if (target.weighting() == weighting) return target;
    }
    return targets_.emplace_back(map_, weighting);
  }

  const WeightedVoxelMap& map() const { return map_; }

 private:
  WeightedVoxelMap map_;
  std::vector<NdtTarget> targets_;
};

/// A localizer at its initial pose.
ScanLocalizer startedAt(const Eigen::Isometry3d& T_map_base, std::shared_ptr<Localizer> localizer) {
  localizer->setInitialPose(T_map_base);
  return [localizer](const ScanView& scan, double stamp_s, const ScanPriors& priors) {
    return localizer->localize(scan, stamp_s, priors);
  };
}

LocalizerOptions optionsOf(const std::string& method, LocalizerOptions options) {
  if (method != kPclNdtMethod) {
    options.method = LocalizationMethod::named(method);
    return options;
  }
  options.method = LocalizationMethod::named("classical");
  options.method.name = kPclNdtMethod;
  options.acceptance.min_likelihood = 0.0;
  return options;
}

template <typename Value>
void requireDifferent(const std::vector<Value>& values, const char* name) {
  if (values.empty()) throw std::invalid_argument(std::string(name) + ": there is none");
  if (std::set<Value>(values.begin(), values.end()).size() != values.size()) {
    throw std::invalid_argument(std::string(name) + ": one is given twice");
  }
}

std::vector<double> stampsOf(const Recording& recording, const std::vector<int>& scans) {
  std::vector<double> stamps_s;
  for (const int scan : scans) stamps_s.push_back(recording.stamps()[static_cast<std::size_t>(scan)]);
  return stamps_s;
}

// The reference poses of scans, which a benchmark cannot do without.
std::vector<Eigen::Isometry3d> referencePoses(const Recording& recording, const std::vector<int>& scans) {
  std::vector<Eigen::Isometry3d> T_map_lidar;
  for (const int scan : scans) {
    const std::optional<Eigen::Isometry3d> pose = recording.referencePose(scan);
    if (!pose) throw Error(recording.path().string(), recording.scanName(scan), "has no reference pose");
    T_map_lidar.push_back(*pose);
  }
  return T_map_lidar;
}

void begin(const BenchmarkProgress& progress, const std::string& description, std::size_t steps) {
  if (progress.stage_begins) progress.stage_begins(description, steps);
}

}  // namespace

const char* toString(MapDrive drive) { return drive == MapDrive::SAME ? "same drive" : "other drive"; }

const char* shortName(MapDrive drive) { return drive == MapDrive::SAME ? "same" : "other"; }

std::vector<std::string> benchmarkMethodNames() {
  std::vector<std::string> names = LocalizationMethod::names();
  names.emplace_back(kPclNdtMethod);
  return names;
}

void BenchmarkOptions::check() const {
  requireDifferent(methods, "methods");
  requireDifferent(drives, "drives");
  const std::vector<std::string> known = benchmarkMethodNames();
  for (const std::string& method : methods) {
    if (std::find(known.begin(), known.end(), method) != known.end()) continue;
    std::string message = "method = " + method + ": must be one of";
    for (const std::string& name : known) message += " " + name;
    throw std::invalid_argument(message);
  }
  checkOption(skip_s >= 0.0, "skip_s", skip_s, "0 or more");
  WeightedMapBuilder{resolution_m};
  localizer.check();
}

Benchmark::Benchmark(std::vector<BenchmarkDrive> drives, BenchmarkOptions options)
    : drives_(std::move(drives)), options_((options.check(), std::move(options))) {
  std::vector<std::string> names;
  for (const BenchmarkDrive& drive : drives_) names.push_back(drive.recording->name());
  requireDifferent(names, "names of the drives");
  for (const BenchmarkDrive& drive : drives_) {
    const std::vector<int> scans = parseScanSelection(options_.scans, drive.recording->scanCount());
    referencePoses(*drive.recording, scans);
    if (!anyScanAfterSkip(stampsOf(*drive.recording, scans), options_.skip_s)) {
      std::ostringstream message;
      message << "skip_s = " << options_.skip_s << ": " << drive.recording->path().string()
              << " has no scan left after so many seconds: lower -skip, to 0 for a short drive";
      throw std::invalid_argument(message.str());
    }
    for (const MapDrive map_drive : options_.drives) {
      if (map_drive == MapDrive::OTHER && !drive.other) {
        throw std::invalid_argument(drive.recording->path().string() + ": no other drive is given for its map");
      }
      const Recording& source = map_drive == MapDrive::SAME ? *drive.recording : *drive.other;
      referencePoses(source, parseScanSelection(options_.map_scans, source.scanCount()));
    }
  }
}

std::size_t Benchmark::stageCount() const {
  const bool with_pcl = std::count(options_.methods.begin(), options_.methods.end(), kPclNdtMethod) > 0;
  return drives_.size() * options_.drives.size() * (with_pcl ? 3 : 2);
}

std::vector<BenchmarkRun> Benchmark::run(const BenchmarkProgress& progress) const {
  std::vector<BenchmarkRun> runs;
  for (const MapDrive map_drive : options_.drives) {
    for (const BenchmarkDrive& drive : drives_) runs.push_back(runDrive(drive, map_drive, progress));
  }
  return runs;
}

BenchmarkRun Benchmark::runDrive(const BenchmarkDrive& drive, MapDrive map_drive,
                                 const BenchmarkProgress& progress) const {
  const Recording& source = map_drive == MapDrive::SAME ? *drive.recording : *drive.other;
  const std::vector<int> map_scans = parseScanSelection(options_.map_scans, source.scanCount());
  const std::vector<int> scans = parseScanSelection(options_.scans, drive.recording->scanCount());
  const LocalizerOptions& common = options_.localizer;
  const std::string prefix = drive.recording->name() + ", " + toString(map_drive) + ": ";

  BenchmarkRun result;
  result.sequence = drive.recording->name();
  result.drive = map_drive;
  result.map_scans = map_scans.size();
  result.T_base_lidar = common.T_base_lidar;
  result.T_camera_lidar = drive.recording->cameraCalibration().value_or(Eigen::Isometry3d::Identity());
  result.skip_s = options_.skip_s;
  result.min_likelihood = common.acceptance.min_likelihood;
  for (const Eigen::Isometry3d& T_map_lidar : referencePoses(*drive.recording, scans)) {
    result.T_map_base.push_back(T_map_lidar * common.T_base_lidar.inverse());
  }

  begin(progress, prefix + "building the map from " + std::to_string(map_scans.size()) + " scans", map_scans.size());
  DriveMapOptions map_options;
  map_options.resolution_m = options_.resolution_m;
  map_options.segmentation = common.segmentation;
  map_options.threads = common.alignment.threads;
  MapTargets targets(buildDriveMap(*source.scans(map_scans), map_options, progress.step_done).build());
  result.voxels = voxelCloud(targets.map());

  std::vector<ScanLocalizer> localizers;
  for (const std::string& method : options_.methods) {
    const LocalizerOptions options = optionsOf(method, common);
    const NdtTarget target = targets.with(options.method.voxels);
    if (method == kPclNdtMethod) {
      begin(progress, prefix + "giving PCL the points of " + std::to_string(map_scans.size()) + " scans",
            map_scans.size());
      SourceAligner pcl =
          pclNdtAligner(mapPoints(*source.scans(map_scans), progress.step_done), target.resolution(), target);
      localizers.push_back(startedAt(result.T_map_base.front(), std::make_shared<Localizer>(std::move(pcl), options)));
    } else {
      localizers.push_back(startedAt(result.T_map_base.front(), std::make_shared<Localizer>(target, options)));
    }
  }

  const std::size_t turns = scans.size() * localizers.size();
  begin(progress,
        prefix + "localizing " + std::to_string(scans.size()) + " scans by " + std::to_string(localizers.size()) +
            (localizers.size() == 1 ? " method" : " methods"),
        turns);
  std::vector<DriveLocalization> runs = localizeByTurns(localizers, *drive.recording->scans(scans), progress.step_done);
  for (std::size_t m = 0; m < runs.size(); ++m) {
    const std::string& method = options_.methods[m];
    LocalizerOptions options = optionsOf(method, common);
    if (method == kPclNdtMethod) options.alignment.threads = 1;
    LocalizationSummary summary = summarize(runs[m], options, options_.skip_s);
    result.cells.push_back({method, std::move(runs[m]), std::move(summary)});
  }
  return result;
}

}  // namespace saw_ndt
