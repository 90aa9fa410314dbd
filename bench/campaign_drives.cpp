#include "campaign_drives.h"

#include <algorithm>
#include <iostream>
#include <memory>
#include <numeric>

#include "output_folder.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "scene_files.h"
#include "simulation/lidar_simulator.h"
#include "simulation/scene_builder.h"
#include "simulation/sequence_writer.h"
#include "simulation/simulated_drive.h"

namespace saw_ndt {
namespace {

constexpr double kSparseDensity = 0.67;
constexpr double kDenseTraffic = 4.0;
constexpr double kBraking_s = 3.0, kStanding_s = 4.0;

const char* folderName(CampaignDrive drive) {
  switch (drive) {
    case CampaignDrive::MAP:
      return "map";
    case CampaignDrive::SPARSE_MAP:
      return "sparse_map";
    case CampaignDrive::TEST:
      return "test";
    case CampaignDrive::DENSE_TRAFFIC:
      return "dense_traffic";
    case CampaignDrive::BRAKING:
      return "braking";
  }
  return "";
}

DriveOptions optionsOf(CampaignDrive drive) {
  DriveOptions options;
  options.drive = drive == CampaignDrive::MAP || drive == CampaignDrive::SPARSE_MAP ? 1 : 2;
  if (drive == CampaignDrive::SPARSE_MAP) options.object_density = kSparseDensity;
  if (drive == CampaignDrive::DENSE_TRAFFIC) options.traffic_density = kDenseTraffic;
  return options;
}

/// The beginning of a motion, where the vehicle then brakes evenly and stands: t seconds after it began to brake, it is
/// where the given motion is after t - t^2 / (2 kBraking_s).
VehicleMotion braked(const VehicleMotion& motion, double scan_period_s) {
  const int scans = static_cast<int>((kBrakingStart_s + kBraking_s + kStanding_s) / scan_period_s);
  VehicleMotion result;
  for (int scan = 0; scan < scans; ++scan) {
    const double stamp_s = scan_period_s * scan;
    const double braking_s = std::clamp(stamp_s - kBrakingStart_s, 0.0, kBraking_s);
    const double driving_s = std::min(stamp_s, kBrakingStart_s);
    result.stamps_s.push_back(stamp_s);
    result.T_scene_lidar.push_back(motion.poseAt(driving_s + braking_s - braking_s * braking_s / (2.0 * kBraking_s)));
  }
  return result;
}

void simulate(const std::filesystem::path& folder, const SceneDescription& description, CampaignDrive which,
              int threads) {
  const DriveOptions options = optionsOf(which);
  LidarOptions lidar;
  lidar.seed = options.seed * 1000003u + static_cast<std::uint64_t>(options.drive);
  SimulatedDrive drive = driveCourse(description, options, lidar.scan_period_s, 0);
  if (which == CampaignDrive::BRAKING) {
    drive.motion = std::make_shared<const VehicleMotion>(braked(*drive.motion, lidar.scan_period_s));
    drive.scene = buildScene(description, drive.route, drive.terrain, drive.motion, options);
  }
  LidarSimulator simulator(drive.scene, lidar, threads);
  writeSequence(folder, simulator, *drive.motion);
}

std::vector<int> allScans(const KittiSequence& sequence) {
  std::vector<int> numbers(static_cast<std::size_t>(sequence.scanCount()));
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

}  // namespace

CampaignDrives::CampaignDrives(std::filesystem::path folder, const LocalizationMethod& method, int threads)
    : folder_(std::move(folder)), method_(method), threads_(threads) {}

std::filesystem::path CampaignDrives::sequenceFolder(const std::string& scene, CampaignDrive drive) {
  const SceneDescription description = readSceneDescription(sceneFile(scene));
  const std::filesystem::path folder = folder_ / description.name / folderName(drive);
  if (std::filesystem::is_directory(folder)) return folder;
  std::cerr << description.name << ": simulating drive '" << folderName(drive) << "'" << std::endl;
  // A run that is ended leaves a folder of another name, for the sequence in it would look whole.
  const std::filesystem::path unfinished = folder.string() + ".unfinished";
  std::filesystem::remove_all(unfinished);
  OutputFolder output(unfinished.string());
  simulate(output.path(), description, drive, threads_);
  output.keep();
  std::filesystem::rename(unfinished, folder);
  return folder;
}

LoadedDrive CampaignDrives::load(const std::string& scene, CampaignDrive drive) {
  const KittiSequence sequence(sequenceFolder(scene, drive));
  LoadedDrive loaded;
  loaded.stamps_s = sequence.stamps();
  loaded.T_map_lidar = sequence.posesLidar();
  for (int scan = 0; scan < sequence.scanCount(); ++scan) loaded.scans.push_back(sequence.readScan(scan));
  return loaded;
}

const NdtTarget& CampaignDrives::target(const std::string& scene, CampaignDrive drive) {
  const auto found = targets_.find({scene, drive});
  if (found != targets_.end()) return found->second;
  const KittiSequence sequence(sequenceFolder(scene, drive));
  std::cerr << scene << ": building the map of drive '" << folderName(drive) << "'" << std::endl;
  DriveMapOptions options;
  options.threads = threads_;
  const WeightedVoxelMap map = buildDriveMap(*sequence.scans(allScans(sequence)), options).build();
  return targets_.emplace(std::make_pair(scene, drive), NdtTarget(map, method_.voxels, threads_)).first->second;
}

Eigen::Isometry3d CampaignDrives::courseStart(const std::string& scene) {
  return KittiSequence(sequenceFolder(scene, CampaignDrive::MAP)).posesLidar().front();
}

}  // namespace saw_ndt
