#include <iostream>
#include <optional>

#include "app_options.h"
#include "io/stamp_check.h"
#include "live_scans.h"
#include "localize_arguments.h"
#include "localize_run.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/drives/scan_selection.h"

namespace {

constexpr char kDescription[] =
    "Follows a drive through a map, scan by scan, and writes trajectory_tum.txt (poses of the base), "
    "trajectory_kitti.txt (of the left camera where the recording tells its place, else of the LiDAR), frames.csv (a "
    "line a scan) and summary.json into OUT_DIR; the summary "
    "is printed too. A scan that is rejected gets the pose that was predicted for it, and none as long as nobody knows "
    "where the vehicle is; where none is located the drive has failed. The sensor must be alike that of the map; the "
    "rule and slope of the ground are those of the map unless stated. Where reference poses exist, that of the first "
    "scan is the initial pose, and all together "
    "they tell the errors. A vehicle that is lost is looked for, first around its prediction, "
    "then in all of the map.";

saw_ndt::TiledTarget loadTarget(const std::string& file, const saw_ndt::LocalizerOptions& options) {
  saw_ndt::TiledTarget target =
      saw_ndt::TiledTarget::open(file, options.method.voxels, options.tiles, options.alignment.threads);
  if (options.method.segment && !target.labelled()) {
    throw saw_ndt::Error(file, "",
                         "was built with -classical: it has no labels, which the method " + options.method.name +
                             " needs; use -method classical or build it without");
  }
  return target;
}

/// The pose of the base at the first scan; nothing where it is unknown. @throws UsageError where one must be stated
std::optional<Eigen::Isometry3d> initialPose(const saw_ndt::AppOptions& app,
                                             const saw_ndt::LocalizeArguments& arguments,
                                             const saw_ndt::Recording& recording, int first_scan) {
  if (app.isGiven("initial-pose")) return arguments.statedInitialPose();
  if (!recording.hasPoses()) {
    throw saw_ndt::UsageError(arguments.sequence + ": no reference poses: option -initial-pose is needed");
  }
  const std::optional<Eigen::Isometry3d> T_map_lidar = recording.referencePose(first_scan);
  if (!T_map_lidar) {
    throw saw_ndt::UsageError(recording.scanName(first_scan) +
                              " has no reference pose: option -initial-pose is needed");
  }
  return *T_map_lidar * arguments.options.T_base_lidar.inverse();
}

void localizeRecording(const saw_ndt::AppOptions& app, const saw_ndt::LocalizeArguments& arguments) {
  const std::unique_ptr<saw_ndt::Recording> recording = arguments.recording.open(arguments.sequence);
  const std::vector<int> selected =
      saw_ndt::checkedUsage([&] { return saw_ndt::parseScanSelection(arguments.scans, recording->scanCount()); });
  const std::vector<double>& stamps_s = recording->stamps();
  const std::optional<Eigen::Isometry3d> T_map_base_initial = initialPose(app, arguments, *recording, selected.front());
  const Eigen::Isometry3d T_camera_lidar = recording->cameraCalibration().value_or(Eigen::Isometry3d::Identity());
  const auto openScans = [&] {
    std::unique_ptr<saw_ndt::ScanSource> source = recording->scans(selected);
    if (!arguments.odometry_file.empty()) {
      source = saw_ndt::withOdometry(std::move(source), arguments.odometry_file, arguments.drift);
    }
    if (!arguments.gnss_file.empty()) {
      source = saw_ndt::withPositions(std::move(source), arguments.gnss_file, arguments.gnss_sigma_m);
    }
    return source;
  };

  saw_ndt::LocalizerOptions options = arguments.options;
  const saw_ndt::TiledTarget target = loadTarget(arguments.map_file, options);
  if (options.method.segment) {
    options.segmentation =
        arguments.segmentation.learnedFrom(saw_ndt::firstScans(*recording->scans(selected)),
                                           {options.T_base_lidar.linear(), target.origin().segmentation});
  }
  options.scan_period_s = recording->scanPeriod();
  const saw_ndt::MotionTrial motion = arguments.motion.decide(app, *recording, selected, [&] {
    return saw_ndt::tryMotionCompensation(target, options, T_map_base_initial, *openScans());
  });
  options.motion_compensation = motion.compensation;

  saw_ndt::LocalizeRun run(app, arguments);
  for (const std::string& odd : saw_ndt::internal::oddStamps(stamps_s)) {
    saw_ndt::warn(app, recording->stampsPlace() + ": " + odd);
  }
  run.localize(target, options, motion, T_map_base_initial, *openScans(), T_camera_lidar);
}

void localizeLive(const saw_ndt::AppOptions& app, const saw_ndt::LocalizeArguments& arguments) {
  for (const char* option : {"scans", "poses", "odometry", "gnss"}) {
    if (app.isGiven(option)) throw saw_ndt::UsageError(std::string("option -") + option + ": excludes a live source");
  }
  if (!app.isGiven("initial-pose")) {
    throw saw_ndt::UsageError(arguments.sequence + ": has no reference poses: option -initial-pose is needed");
  }
  std::unique_ptr<saw_ndt::LiveSource> source;  // lives longer than what may stop it
  saw_ndt::Interruption interruption;
  saw_ndt::LocalizerOptions options = arguments.options;
  const saw_ndt::TiledTarget target = loadTarget(arguments.map_file, options);
  saw_ndt::LocalizeRun run(app, arguments);
  source = saw_ndt::openLive(arguments);
  interruption.onFirst([&] { source->stop(); });
  std::cerr << app.name() << ": waiting for scans of " << arguments.sequence << "; SIGINT (Ctrl-C) or SIGTERM ends\n";

  saw_ndt::LiveScans scans(*source);
  const std::vector<saw_ndt::ScanPoints> first = scans.waitForFirst();
  if (options.method.segment && !first.empty()) {
    options.segmentation =
        arguments.segmentation.learnedFrom(first, {options.T_base_lidar.linear(), target.origin().segmentation});
  }
  options.scan_period_s = scans.scanPeriod();
  const saw_ndt::MotionTrial motion = arguments.motion.decideLive(first);
  options.motion_compensation = motion.compensation;
  run.localize(target, options, motion, arguments.statedInitialPose(), scans, Eigen::Isometry3d::Identity(),
               source.get());
}

}  // namespace

int main(int argc, char** argv) {
  saw_ndt::LocalizeArguments arguments;
  saw_ndt::AppOptions app("saw_ndt_localize", kDescription);
  arguments.addTo(app);
  return saw_ndt::runApp(argc, argv, app, [&] {
    arguments.check(app);
    saw_ndt::isLive(arguments) ? localizeLive(app, arguments) : localizeRecording(app, arguments);
  });
}
