#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>

#include "localize_arguments.h"
#include "output_folder.h"
#include "progress_bar.h"
#include "report/localization_summary.h"
#include "report/pose_stream.h"
#include "saw_ndt/drives/drive_localization.h"
#include "saw_ndt/drives/live_source.h"
#include "saw_ndt/drives/motion_trial.h"
#include "saw_ndt/map/tiled_target.h"

namespace saw_ndt {

/// A run of saw_ndt_localize through scans, recorded or live: what is told meanwhile, and what is written in the end.
class LocalizeRun {
 public:
  /// Makes the folder and opens the stream of poses, where one is asked for. @throws Error where that fails
  LocalizeRun(const AppOptions& app, const LocalizeArguments& arguments);

  /// Localizes all scans of a source and writes the results.
  /// @param live  the source where it is a live one, else null
  /// @throws Error where no scan was located or, with -strict, one could not be read; results are written all the same
  void localize(const TiledTarget& target, const LocalizerOptions& options, const MotionTrial& motion,
                const std::optional<Eigen::Isometry3d>& T_map_base_initial, ScanSource& scans,
                const Eigen::Isometry3d& T_camera_lidar, const LiveSource* live = nullptr);

 private:
  void tell(const RecordedScan& scan, const LocalizationResult& result, std::size_t left_out);
  void tellTiles(const LocalizationSummary& summary) const;
  void tellScansWithoutTimes(const DriveLocalization& run, const MotionTrial& motion) const;

  const AppOptions& app_;
  const LocalizeArguments& arguments_;
  OutputFolder folder_;
  std::optional<PoseStream> stream_;
  bool was_lost_ = false;
};

}  // namespace saw_ndt
