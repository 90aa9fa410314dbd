#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "saw_ndt/evaluation/metrics.h"
#include "evaluation/statistics.h"
#include "saw_ndt/io/kitti.h"
#include "saw_ndt/localization/localizer.h"

namespace saw_ndt {

/// A drive localized scan by scan.
struct SequenceLocalization {
  std::vector<int> scans;                   ///< numbers of the scans, in order
  std::vector<LocalizationResult> results;  ///< one a scan
};

/// Localizes the given scans of a drive one after the other. Reading a scan is no part of its times.
/// @param scan_done  called after each scan; may be empty
/// @throws Error where a file is missing or damaged
SequenceLocalization localizeSequence(Localizer& localizer, const KittiSequence& sequence,
                                      const std::vector<int>& scans, const std::function<void()>& scan_done = {});

/// One way of localizing a scan: that of a Localizer or of another method.
using ScanLocalizer = std::function<LocalizationResult(const ScanView& scan, double stamp_s)>;

/// The same for several methods at once. They take turns at every scan, another one first each time, so that a slow
/// moment of the machine hits all of them; a scan is read once.
/// @param turn_done  called after each turn, scans times methods in all; may be empty
/// @return one run a method, in their order
std::vector<SequenceLocalization> localizeByTurns(const std::vector<ScanLocalizer>& localizers,
                                                  const KittiSequence& sequence, const std::vector<int>& scans,
                                                  const std::function<void()>& turn_done = {});

/// Whether metrics that leave out the first `skip_s` seconds have a scan left. @param stamps_s  of the whole drive
bool anyScanAfterSkip(const std::vector<int>& scans, const std::vector<double>& stamps_s, double skip_s);

/// The figures of a run; the fields are those of summary.json.
struct LocalizationSummary {
  std::string method;
  std::size_t scans = 0, accepted = 0, rejected = 0;
  DurationStatistics total_ms, segment_ms, filter_ms, align_ms;
  double source_points_mean = 0.0;
  double iterations_mean = 0.0, evaluations_mean = 0.0;
  double likelihood_mean = 0.0, nearest_voxel_likelihood_mean = 0.0, non_ground_likelihood_mean = 0.0;
  double peak_rss_mb = 0.0;  ///< of this process, so far
  int threads = 0;
  std::optional<TrajectoryMetrics> metrics;  ///< where a reference exists
};

/// @param T_base_lidar     the localizer's mounting of the LiDAR
/// @param reference_lidar  reference pose of the LiDAR for every scan of the drive; empty: no metrics
/// @param skip_s           seconds at the start that the metrics leave out
LocalizationSummary summarize(const SequenceLocalization& run, const LocalizerOptions& options,
                              const std::vector<Eigen::Isometry3d>& reference_lidar,
                              const std::vector<double>& stamps_s, double skip_s);

/// The summary as one JSON object with a line break at its end.
std::string toJsonText(const LocalizationSummary& summary);

/// Writes trajectory_tum.txt (poses of the base), trajectory_kitti.txt (of the left camera), frames.csv and
/// summary.json into a folder that exists. @throws Error
void writeLocalization(const std::filesystem::path& folder, const SequenceLocalization& run,
                       const LocalizationSummary& summary, const Eigen::Isometry3d& T_base_lidar,
                       const Eigen::Isometry3d& T_camera_lidar);

}  // namespace saw_ndt
