#include "benchmark_scans.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "localization/source_voxel_filter.h"
#include "report/pcl_ndt.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/localization/localizer.h"
#include "saw_ndt/pcl/cloud_view.h"
#include "saw_ndt/pcl/ground_subsampling.h"
#include "temporary_folder.h"
#ifdef SAW_NDT_SIMULATION
#include "simulation/lidar_simulator.h"
#include "simulation/sequence_writer.h"
#include "simulation/simulated_drive.h"
#endif

namespace saw_ndt {

using namespace internal;

namespace {

constexpr int kMostScans = 70;
constexpr char kPreferredSequence[] = "drive_0005";

struct Drive {
  std::unique_ptr<TemporaryFolder> simulated;
  std::unique_ptr<KittiSequence> sequence;
  std::string description;
};

Drive driveOf(const std::filesystem::path& kitti) {
  const std::filesystem::path sequences = kitti / "sequences";
  if (!std::filesystem::is_directory(sequences)) {
    throw Error(sequences.string(), "", "is no folder; the environment variable SAW_NDT_KITTI names the one above it");
  }
  std::filesystem::path folder = sequences / kPreferredSequence;
  if (!std::filesystem::is_directory(folder)) {
    std::vector<std::filesystem::path> folders;
    for (const auto& entry : std::filesystem::directory_iterator(sequences)) {
      if (entry.is_directory()) folders.push_back(entry.path());
    }
    if (folders.empty()) throw Error(sequences.string(), "", "holds no sequence");
    folder = *std::min_element(folders.begin(), folders.end());
  }
  Drive drive;
  drive.sequence = std::make_unique<KittiSequence>(folder);
  drive.description = drive.sequence->name() + " of " + kitti.string();
  return drive;
}

#ifdef SAW_NDT_SIMULATION
constexpr int kSimulatedScans = 24;

Drive simulatedDrive() {
  Drive drive;
  drive.simulated = std::make_unique<TemporaryFolder>();
  const SceneDescription scene = readSceneDescription(SAW_NDT_SOURCE_DIR "/data/scenes/residential.json");
  const LidarOptions lidar;
  const SimulatedDrive simulated = driveCourse(scene, {}, lidar.scan_period_s, kSimulatedScans);
  LidarSimulator simulator(simulated.scene, lidar);
  writeSequence(drive.simulated->path(), simulator, *simulated.motion);
  drive.sequence = std::make_unique<KittiSequence>(drive.simulated->path());
  drive.description = "simulated " + scene.name + " drive";
  return drive;
}
#else
Drive simulatedDrive() {
  throw Error("SAW_NDT_KITTI", "",
              "names no KITTI folder, and this program was built without Embree, which simulates a drive instead");
}
#endif

const Drive& drive() {
  static const Drive result = [] {
    const char* const kitti = std::getenv("SAW_NDT_KITTI");
    return kitti != nullptr && *kitti != '\0' ? driveOf(kitti) : simulatedDrive();
  }();
  return result;
}

}  // namespace

const KittiSequence& benchmarkSequence() { return *drive().sequence; }

const std::string& benchmarkSequenceDescription() { return drive().description; }

const std::vector<Eigen::Isometry3d>& benchmarkPoses() {
  static const std::vector<Eigen::Isometry3d> poses = benchmarkSequence().posesLidar();
  return poses;
}

const std::vector<int>& benchmarkMapScans() {
  static const std::vector<int> scans = [] {
    std::vector<int> even;
    for (int scan = 0; scan < std::min(kMostScans, benchmarkSequence().scanCount()); scan += 2) even.push_back(scan);
    return even;
  }();
  return scans;
}

int benchmarkScanNumber() {
  const int scan_count = std::min(kMostScans, benchmarkSequence().scanCount());
  return std::min(scan_count / 2 | 1, scan_count - 1);
}

const std::vector<LidarPoint>& benchmarkScan() {
  static const std::vector<LidarPoint> scan = benchmarkSequence().readScan(benchmarkScanNumber());
  return scan;
}

pcl::PointCloud<pcl::PointXYZ>::Ptr benchmarkScanPoints() {
  auto points = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (const LidarPoint& point : benchmarkScan()) points->emplace_back(point.x, point.y, point.z);
  return points;
}

const Eigen::Isometry3d& benchmarkPose() { return benchmarkPoses()[static_cast<std::size_t>(benchmarkScanNumber())]; }

const WeightedVoxelMap& benchmarkMap() {
  static const WeightedVoxelMap map = buildDriveMap(*benchmarkSequence().scans(benchmarkMapScans()), {}).build();
  return map;
}

pcl::PointCloud<pcl::PointXYZ>::Ptr benchmarkTarget(std::size_t most) {
  static const pcl::PointCloud<pcl::PointXYZ>::Ptr all = mapPoints(*benchmarkSequence().scans(benchmarkMapScans()));
  if (most >= all->size()) return all;
  auto first = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (std::size_t i = 0; i < most; ++i) first->push_back((*all)[i]);
  return first;
}

SourcePoints benchmarkSource(const std::vector<LidarPoint>& scan, const LocalizationMethod& method) {
  const ScanView view = viewOf(scan);
  std::vector<StructuralLabel> labels(scan.size(), StructuralLabel::NON_GROUND);
  if (method.segment) ScanSegmenter().segment(view, labels);
  SourceVoxelFilter filter(LocalizerOptions().source_voxel_size_m);
  return filter.filter(view, method.segment ? &labels : nullptr,
                       {method.ground_ratio, method.voxels.confidence, Eigen::Isometry3d::Identity()});
}

}  // namespace saw_ndt
