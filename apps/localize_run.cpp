#include "localize_run.h"

#include <algorithm>
#include <csignal>
#include <iostream>

#include "report/localization_summary.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {

LocalizeRun::LocalizeRun(const AppOptions& app, const LocalizeArguments& arguments)
    : app_(app), arguments_(arguments), folder_(arguments.out_dir) {
  if (arguments.stream_file.empty()) return;
  // A reader that goes away is told by the write that fails.
  std::signal(SIGPIPE, SIG_IGN);
  stream_.emplace(arguments.stream_file,
                  arguments.stream_format == "tum" ? PoseStreamFormat::TUM : PoseStreamFormat::JSON);
}

void LocalizeRun::tell(const RecordedScan& scan, const LocalizationResult& result, std::size_t left_out) {
  const bool is_lost = result.track.isLost();
  if (is_lost && !was_lost_) std::cerr << app_.name() << ": lost at scan " << scan.number << '\n';
  was_lost_ = is_lost;
  if (!scan.failure.empty()) std::cerr << app_.name() << ": " << scan.failure << ": rejected\n";
  if (!stream_ || stream_->write(scan, result, left_out)) return;
  warn(app_, arguments_.stream_file + ": could not be written: no further poses are written there");
  stream_.reset();
}

void LocalizeRun::tellScansWithoutTimes(const DriveLocalization& run, const MotionTrial& motion) const {
  std::size_t without_times = 0;
  for (const LocalizationResult& result : run.results) {
    without_times += result.acceptance != Acceptance::UNREADABLE && !result.motion_compensated ? 1 : 0;
  }
  if (motion.compensation == MotionCompensation::OFF || without_times == 0) return;
  warn(app_, "-motion-compensation " + std::string(toString(motion.compensation)) + ": the points of " +
                 std::to_string(without_times) + " scans have no times: these were taken as they are");
}

void LocalizeRun::tellTiles(const LocalizationSummary& summary) const {
  if (!summary.tiles) return;
  const TileLoads& tiles = *summary.tiles;
  if (tiles.waits > 0) {
    warn(app_, std::to_string(tiles.waits) + " times a scan waited for tiles of " + arguments_.map_file + ", " +
                   std::to_string(tiles.longest_wait_ms) + " ms at most");
  }
  if (tiles.least_radius_m > 0.0) {
    warn(app_, "-map-memory " + std::to_string(arguments_.map_memory_mb) + " MB left room for tiles " +
                   std::to_string(tiles.least_radius_m) + " m around the vehicle alone");
  }
}

void LocalizeRun::localize(const TiledTarget& target, const LocalizerOptions& options, const MotionTrial& motion,
                           const std::optional<Eigen::Isometry3d>& T_map_base_initial, ScanSource& scans,
                           const Eigen::Isometry3d& T_camera_lidar, const LiveSource* live) {
  Localizer localizer(target, options);
  if (T_map_base_initial) {
    localizer.setInitialPose(*T_map_base_initial);
  } else {
    localizer.setUnknownPose();
  }
  std::optional<ProgressBar> progress;
  if (scans.scanCount()) progress.emplace(*scans.scanCount());
  const DriveLocalization run =
      localizeDrive(localizer, scans, [&](const RecordedScan& scan, const LocalizationResult& result) {
        tell(scan, result, live != nullptr ? live->leftOut() : 0);
        if (progress) progress->step();
      });
  progress.reset();
  if (run.results.empty()) throw Error(arguments_.sequence, "", "no scan came");
  tellScansWithoutTimes(run, motion);

  LocalizationSummary summary = summarize(run, localizer.options(), arguments_.skip_s);
  summary.motion_compensation_reason = motion.reason;
  if (target.map()) summary.tiles = *localizer.tileLoads();
  tellTiles(summary);
  if (live != nullptr) summary.left_out = live->leftOut();
  const bool has_reference = std::any_of(run.T_map_lidar_reference.begin(), run.T_map_lidar_reference.end(),
                                         [](const auto& pose) { return pose.has_value(); });
  if (has_reference && !summary.metrics && summary.accepted > 0) {
    std::cerr << app_.name() << ": no scan is left after -skip " << arguments_.skip_s
              << " s: the summary has no errors\n";
  }
  writeLocalization(folder_.path(), run, summary, options.T_base_lidar, T_camera_lidar);
  folder_.keep();
  if (arguments_.stream_file != "-") std::cout << toJsonText(summary);
  if (summary.left_out.value_or(0) > 0) {
    std::cerr << app_.name() << ": " << *summary.left_out << " scans were left out for newer ones\n";
  }
  if (summary.accepted == 0) {
    throw Error(arguments_.sequence, "",
                "no scan was located in " + arguments_.map_file +
                    ", the first one for: " + toString(run.results.front().acceptance));
  }
  const auto unreadable = std::count_if(run.failures.begin(), run.failures.end(),
                                        [](const std::string& failure) { return !failure.empty(); });
  if (arguments_.strict && unreadable > 0) {
    throw Error(arguments_.sequence, "", std::to_string(unreadable) + " scans could not be read (-strict)");
  }
}

}  // namespace saw_ndt
