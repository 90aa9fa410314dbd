#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "campaign_drives.h"
#include "saw_ndt/localization/motion_prediction.h"

namespace saw_ndt {

/// A scan as a localizer gets it in a run of the campaign.
struct PlayedScan {
  std::size_t recorded = 0;  ///< its number in the drive
  double stamp_s = 0.0;      ///< as stated, which a fault may have made a false one
  Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity();  ///< true pose of the LiDAR when it took the scan
  std::function<void(std::vector<LidarPoint>&)> alter;            ///< what a fault does to its points; empty: nothing
  bool shows_nothing = false;                                     ///< no pose can follow from its points
  ScanPriors priors;                                              ///< of other sensors
};

/// What a localizer is given from the initial pose to the last scan.
struct CampaignRun {
  std::optional<Eigen::Isometry3d> T_map_base_initial;  ///< nothing: nobody knows where the run starts
  std::vector<PlayedScan> scans;
  std::size_t fault_begin = 0;  ///< the first scan that a fault is seen in, and that counts
  std::size_t fault_end = 0;    ///< the first one that is good again; no later than fault_begin where that is at once
  bool place_in_map = true;     ///< false: no accepted pose can be right

  /// Scans of a drive as they were recorded, from `first` on, `count` of them or to its end, from the true pose.
  static CampaignRun recorded(const LoadedDrive& drive, std::size_t first, std::size_t count) {
    CampaignRun run;
    for (std::size_t i = first; i < drive.scans.size() && i < first + count; ++i) {
      run.scans.push_back({i, drive.stamps_s[i], drive.T_map_lidar[i], {}, false, {}});
    }
    if (!run.scans.empty()) run.T_map_base_initial = run.scans.front().T_map_lidar;
    return run;
  }
};

}  // namespace saw_ndt
