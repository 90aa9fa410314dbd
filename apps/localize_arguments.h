#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app_options.h"
#include "drives/prior_sources.h"
#include "motion_argument.h"
#include "recording_argument.h"
#include "saw_ndt/localization/localizer.h"
#include "segmentation_options.h"

namespace saw_ndt {

/// The command line of saw_ndt_localize.
struct LocalizeArguments {
  std::string sequence, map_file, out_dir;
  std::string scans = ":";
  double skip_s = 3.0;
  std::string initial_pose;  ///< empty: the reference pose of the first scan
  std::string odometry_file, gnss_file;
  OdometryDrift drift;
  double gnss_sigma_m = 2.0;
  bool strict = false;
  bool follow = false;
  int max_waiting = 5;      ///< scans of a live source
  std::string stream_file;  ///< empty: none
  std::string stream_format = "json";
  double map_memory_mb = 256.0;
  LocalizerOptions options;  ///< segmentation and motion compensation as stated alone
  RecordingArgument recording;
  SegmentationArguments segmentation;
  MotionArgument motion;

  /// Declares them. `app` must live as long as this.
  void addTo(AppOptions& app);

  /// Fills `options` with what was parsed. @throws UsageError that names what does not hold
  void check(const AppOptions& app);

  /// The pose of the base that is stated; nothing where it is unknown or not stated.
  std::optional<Eigen::Isometry3d> statedInitialPose() const;

 private:
  std::string method_;
  std::vector<double> base_lidar_ = std::vector<double>(6, 0.0);
  double initial_radius_m_ = 0.0, initial_yaw_range_deg_ = 0.0;
  bool no_search_ = false;
};

}  // namespace saw_ndt
