#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/statistics.h"
#include "saw_ndt/drives/drive_localization.h"
#include "saw_ndt/evaluation/metrics.h"

namespace saw_ndt {

/// Whether metrics that leave out the first `skip_s` seconds have a scan left. @param stamps_s  of the scans
bool anyScanAfterSkip(const std::vector<double>& stamps_s, double skip_s);

/// How long a localizer was in a state: that of a scan counts from the stamp of the scan before.
struct StateShare {
  std::size_t scans = 0;
  double seconds = 0.0;
};

/// The figures of a run; the fields are those of summary.json.
struct LocalizationSummary {
  std::string method;
  MotionCompensation motion_compensation = MotionCompensation::OFF;
  std::string motion_compensation_reason;  ///< why, where that is known
  std::size_t scans = 0, accepted = 0, rejected = 0;
  StateShare tracking, coasting, relocalizing, lost;
  std::size_t recoveries = 0;        ///< how often a scan was accepted after ones that were not
  std::size_t degenerate_scans = 0;  ///< accepted ones that do not hold the pose in every direction
  internal::DurationStatistics total_ms, segment_ms, filter_ms, align_ms;
  double source_points_mean = 0.0;
  double iterations_mean = 0.0, evaluations_mean = 0.0;
  double likelihood_mean = 0.0, nearest_voxel_likelihood_mean = 0.0, non_ground_likelihood_mean = 0.0;
  std::optional<std::size_t> left_out;  ///< scans of a live source that were left out for newer ones
  std::optional<TileLoads> tiles;       ///< where tiles of a LocalizationMap were loaded
  double peak_rss_mb = 0.0;             ///< of this process, so far
  int threads = 0;
  std::optional<TrajectoryMetrics> metrics;  ///< where a reference exists
};

/// @param options  of the localizer
/// @param skip_s   seconds at the start that the metrics leave out; where no scan is left there are none
LocalizationSummary summarize(const DriveLocalization& run, const LocalizerOptions& options, double skip_s);

/// The summary as one JSON object with a line break at its end.
std::string toJsonText(const LocalizationSummary& summary);

/// Writes trajectory_tum.txt (poses of the base), trajectory_kitti.txt (of the left camera), frames.csv and
/// summary.json into a folder that exists. The trajectories begin where a pose is known. @throws Error
void writeLocalization(const std::filesystem::path& folder, const DriveLocalization& run,
                       const LocalizationSummary& summary, const Eigen::Isometry3d& T_base_lidar,
                       const Eigen::Isometry3d& T_camera_lidar);

}  // namespace saw_ndt
