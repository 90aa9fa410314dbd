#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/localization/localization_method.h"
#include "saw_ndt/map/ndt_target.h"

namespace saw_ndt {

/// The drives through a scene that a fault campaign needs; all of them share what stands.
enum class CampaignDrive {
  MAP,            ///< the first drive
  SPARSE_MAP,     ///< the first drive, a third of the objects gone
  TEST,           ///< another drive
  DENSE_TRAFFIC,  ///< that one among four times the traffic
  BRAKING,        ///< the beginning of that one, where the vehicle then stops within three seconds
};

/// When the vehicle of CampaignDrive::BRAKING begins to brake (s): early in the tunnel, the bridge and the plain.
constexpr double kBrakingStart_s = 12.0;

/// A simulated drive in memory; its poses are exact.
struct LoadedDrive {
  std::vector<double> stamps_s;
  std::vector<Eigen::Isometry3d> T_map_lidar;
  std::vector<std::vector<LidarPoint>> scans;
};

/// Simulates drives of an HDL-64E, each once, and keeps them in a folder as sequences in KITTI layout; builds the maps
/// of those that are to be mapped.
class CampaignDrives {
 public:
  /// @param folder   must exist; drives that it has already are taken from there
  /// @param threads  that simulate and build maps; 0: all cores
  CampaignDrives(std::filesystem::path folder, const LocalizationMethod& method, int threads);

  /// @param scene  a name or file, see sceneFile()
  /// @throws UsageError where there is no such scene, Error where a file cannot be read or written
  LoadedDrive load(const std::string& scene, CampaignDrive drive);

  /// What scans are localized in: the map of a whole drive, built when first asked for and kept.
  const NdtTarget& target(const std::string& scene, CampaignDrive drive);

  /// Where the scene's first drive begins.
  Eigen::Isometry3d courseStart(const std::string& scene);

 private:
  std::filesystem::path sequenceFolder(const std::string& scene, CampaignDrive drive);

  std::filesystem::path folder_;
  LocalizationMethod method_;
  int threads_;
  std::map<std::pair<std::string, CampaignDrive>, NdtTarget> targets_;
};

}  // namespace saw_ndt
