#include <iostream>
#include <optional>

#include "app_options.h"
#include "bin_fields_argument.h"
#include "drives/prior_sources.h"
#include "io/stamp_check.h"
#include "motion_argument.h"
#include "output_folder.h"
#include "pose_argument.h"
#include "progress_bar.h"
#include "report/localization_summary.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/drives/scan_selection.h"
#include "segmentation_options.h"

namespace {

constexpr char kDescription[] =
    "Follows a drive through a map, scan by scan, and writes trajectory_tum.txt (poses of the base), "
    "trajectory_kitti.txt (of the left camera), frames.csv (a line a scan) and summary.json into OUT_DIR; the summary "
    "is printed too. A scan that is rejected gets the pose that was predicted for it, and none as long as nobody knows "
    "where the vehicle is; where none is located the drive has failed. The sensor must be alike that of the map; the "
    "rule and slope of the ground are those of the map unless stated. Where reference poses exist, that of the first "
    "scan is the initial pose, and all together "
    "they tell the errors. A vehicle that is lost is looked for, first around its prediction, "
    "then in all of the map.";

// An uncertainty is given as how far it reaches.
constexpr double kSigmas = 3.0;
constexpr char kUnknown[] = "unknown";

saw_ndt::NdtTarget loadTarget(const std::string& file, const saw_ndt::LocalizationMethod& method, int threads) {
  saw_ndt::NdtTarget target = saw_ndt::NdtTarget::load(file, method.voxels, threads);
  if (method.segment && !target.labelled()) {
    throw saw_ndt::Error(file, "",
                         "was built with -classical: it has no labels, which the method " + method.name +
                             " needs; use -method classical or build it without");
  }
  return target;
}

}  // namespace

int main(int argc, char** argv) {
  std::string sequence_folder, map_file, out_dir, poses_file, scans = ":";
  double skip_s = 3.0;
  std::string initial_pose;
  std::vector<double> base_lidar(6, 0.0);
  saw_ndt::LocalizerOptions options;
  double initial_radius_m = kSigmas * options.prediction.initial_sigma_m;
  double initial_yaw_range_deg = kSigmas * options.prediction.initial_sigma_deg;
  bool no_search = false, strict = false;
  std::string odometry_file, gnss_file;
  saw_ndt::OdometryDrift drift;
  double gnss_sigma_m = 2.0;
  saw_ndt::SegmentationArguments segmentation;
  saw_ndt::BinFieldsArgument bin_fields;
  saw_ndt::MotionArgument motion_argument;
  std::string method = options.method.name;
  saw_ndt::AppOptions app("saw_ndt_localize", kDescription);
  app.addPositional("SEQUENCE", &sequence_folder, "folder in KITTI layout: velodyne/*.bin, calib.txt, times.txt");
  app.addPositional("MAP", &map_file, "map file of saw_ndt_build_map");
  app.addPositional("OUT_DIR", &out_dir, "folder for the results, made where it is missing");
  app.addChoice("method", &method, saw_ndt::LocalizationMethod::names(),
                "weighted is this project's, the others are the paper's");
  app.addOption("scans", &scans, "SLICE", "scans to localize, first:last:step as in Python: `1:70:2`, or all with `:`");
  app.addOption("skip", &skip_s, "SECONDS", "time at the start that the errors leave out; 0 for short drives");
  app.addOption("poses", &poses_file, "FILE",
                "reference poses, KITTI format (default: SEQUENCE/poses.txt, then SEQUENCE/../../poses/<name>.txt)");
  app.addOption("initial-pose", &initial_pose, saw_ndt::kPosePlaceholder,
                "pose of the base in the map at the first scan, metres and degrees, or `unknown`: it is looked for in "
                "all of the map (default: its reference pose)");
  app.addOption("initial-radius", &initial_radius_m, "METRES", "how far from there the base may be");
  app.addOption("initial-yaw-range", &initial_yaw_range_deg, "DEGREES",
                "how much its heading may differ from that, 180 for any");
  app.addOption("odometry", &odometry_file, "FILE",
                "poses of the base by odometry, in a frame of any origin: TUM format, or CSV with the columns stamp_s, "
                "x_m, y_m, z_m, qx, qy, qz, qw, sigma_m, sigma_deg (of the motion since the line before)");
  app.addOption("odometry-drift", &drift.share, "SHARE", "of the way, one sigma, for odometry in TUM format");
  app.addOption("odometry-drift-deg", &drift.deg_per_s, "DEGREES", "in a second, one sigma, likewise");
  app.addOption("gnss", &gnss_file, "FILE",
                "positions of the base in the map: TUM format, or CSV with the columns stamp_s, x_m, y_m, z_m and, "
                "where they are known, sigma_x_m, sigma_y_m, sigma_z_m");
  app.addOption("gnss-sigma", &gnss_sigma_m, "METRES", "of a position whose file does not say");
  app.addOption("search-budget", &options.search_budget_ms, "MS",
                "time for a scan while all of the map is searched, which then goes on beside further scans (default: "
                "until that is done)");
  app.addFlag("no-search", &no_search, "do not look for a pose that is lost, but align from predictions alone");
  app.addOption("base-lidar", &base_lidar, saw_ndt::kPosePlaceholder,
                "pose of the LiDAR on the vehicle's base, metres and degrees; all zero: the base is the LiDAR");
  app.addOption("source-voxel", &options.source_voxel_size_m, "METRES",
                "edge of the voxels that thin a scan, 0 for none");
  app.addOption("max-iterations", &options.alignment.max_iterations, "N", "steps of an alignment at most");
  app.addOption("min-likelihood", &options.acceptance.min_likelihood, "X",
                "a scan whose likelihood without weights (unweighted_likelihood in frames.csv) is less is rejected");
  app.addOption("min-overlap", &options.acceptance.min_overlap, "SHARE",
                "a scan of which less beside the ground lies on surfaces of the map is rejected");
  app.addOption("max-correction", &options.acceptance.max_correction_m, "METRES",
                "a scan moved farther than this from its predicted pose is rejected, unless that is as uncertain");
  app.addOption("max-correction-deg", &options.acceptance.max_correction_deg, "DEGREES",
                "a scan turned farther than this from its predicted pose is rejected, unless that is as uncertain");
  motion_argument.addTo(app);
  app.addFlag("strict", &strict, "a scan that cannot be read makes the run a failure; the results are written");
  bin_fields.addTo(app);
  segmentation.addTo(app);
  app.addFlag("allow-other-segmentation", &options.allow_other_segmentation,
              "go on where the scans of the map were segmented by other options, as those of another LiDAR");

  return saw_ndt::runApp(argc, argv, app, [&] {
    if (skip_s < 0.0) throw saw_ndt::UsageError("option -skip: must be 0 or greater");
    options.method = saw_ndt::LocalizationMethod::named(method);
    options.segmentation = segmentation.stated();
    options.alignment.threads = app.threads();
    options.T_base_lidar = saw_ndt::transformOf(base_lidar);
    options.search = !no_search;
    options.prediction.initial_sigma_m = initial_radius_m / kSigmas;
    options.prediction.initial_sigma_deg = initial_yaw_range_deg / kSigmas;
    saw_ndt::checkedUsage([&] {
      saw_ndt::checkOption(initial_radius_m > 0.0, "initial-radius", initial_radius_m, "positive");
      saw_ndt::checkOption(initial_yaw_range_deg > 0.0 && initial_yaw_range_deg <= 180.0, "initial-yaw-range",
                           initial_yaw_range_deg, "positive and at most 180");
      saw_ndt::checkOption(gnss_sigma_m > 0.0, "gnss-sigma", gnss_sigma_m, "positive");
      saw_ndt::checkOption(drift.share >= 0.0, "odometry-drift", drift.share, "0 or more");
      saw_ndt::checkOption(drift.deg_per_s >= 0.0, "odometry-drift-deg", drift.deg_per_s, "0 or more");
      options.check();
    });
    if (no_search && initial_pose == kUnknown) {
      throw saw_ndt::UsageError("option -initial-pose unknown: excludes -no-search");
    }
    std::optional<Eigen::Isometry3d> T_map_base_initial;  // nothing: unknown
    if (!initial_pose.empty() && initial_pose != kUnknown) {
      T_map_base_initial = saw_ndt::transformOf(saw_ndt::parseNumbers("initial-pose", initial_pose, 6));
    }
    const saw_ndt::KittiSequence sequence(sequence_folder, poses_file, bin_fields.value());
    const std::vector<int> selected =
        saw_ndt::checkedUsage([&] { return saw_ndt::parseScanSelection(scans, sequence.scanCount()); });
    sequence.stamps();
    if (!sequence.hasPoses() && !app.isGiven("initial-pose")) {
      throw saw_ndt::UsageError(sequence_folder + ": no reference poses: option -initial-pose is needed");
    }
    const Eigen::Isometry3d T_camera_lidar = sequence.T_camera_lidar();

    if (initial_pose.empty()) {
      T_map_base_initial =
          sequence.posesLidar()[static_cast<std::size_t>(selected.front())] * options.T_base_lidar.inverse();
    }
    const auto openScans = [&] {
      std::unique_ptr<saw_ndt::ScanSource> source = sequence.scans(selected);
      if (!odometry_file.empty()) source = saw_ndt::withOdometry(std::move(source), odometry_file, drift);
      if (!gnss_file.empty()) source = saw_ndt::withPositions(std::move(source), gnss_file, gnss_sigma_m);
      return source;
    };
    const saw_ndt::NdtTarget target = loadTarget(map_file, options.method, app.threads());
    if (options.method.segment) {
      options.segmentation = segmentation.learnedFrom(saw_ndt::firstScans(*sequence.scans(selected)),
                                                      {options.T_base_lidar.linear(), target.origin().segmentation});
    }
    options.scan_period_s = sequence.scanPeriod();
    const saw_ndt::MotionTrial motion = motion_argument.decide(app, *openScans(), [&] {
      return saw_ndt::tryMotionCompensation(target, options, T_map_base_initial, *openScans());
    });
    options.motion_compensation = motion.compensation;
    saw_ndt::Localizer localizer(target, options);
    if (T_map_base_initial) {
      localizer.setInitialPose(*T_map_base_initial);
    } else {
      localizer.setUnknownPose();
    }

    saw_ndt::OutputFolder folder(out_dir);
    for (const std::string& odd : saw_ndt::internal::oddStamps(sequence.stamps())) {
      saw_ndt::warn(app, (sequence.folder() / "times.txt").string() + ": " + odd);
    }
    const std::unique_ptr<saw_ndt::ScanSource> source = openScans();
    saw_ndt::ProgressBar progress(selected.size());
    bool was_lost = false;
    std::size_t done = 0;
    const saw_ndt::DriveLocalization run = saw_ndt::localizeDrive(localizer, *source, [&] {
      const bool is_lost = localizer.track().isLost();
      if (is_lost && !was_lost) std::cerr << app.name() << ": lost at scan " << selected[done] << '\n';
      was_lost = is_lost;
      ++done;
      progress.step();
    });
    std::size_t unreadable = 0;
    for (const std::string& failure : run.failures) {
      if (failure.empty()) continue;
      std::cerr << app.name() << ": " << failure << ": rejected\n";
      ++unreadable;
    }
    std::size_t without_times = 0;
    for (const saw_ndt::LocalizationResult& result : run.results) {
      without_times += result.acceptance != saw_ndt::Acceptance::UNREADABLE && !result.motion_compensated ? 1 : 0;
    }
    if (motion.compensation != saw_ndt::MotionCompensation::OFF && without_times > 0) {
      saw_ndt::warn(app, "-motion-compensation " + std::string(saw_ndt::toString(motion.compensation)) +
                             ": the points of " + std::to_string(without_times) +
                             " scans have no times: these were taken as they are");
    }
    saw_ndt::LocalizationSummary summary = saw_ndt::summarize(run, localizer.options(), skip_s);
    summary.motion_compensation_reason = motion.reason;
    if (sequence.hasPoses() && !summary.metrics && summary.accepted > 0) {
      std::cerr << app.name() << ": no scan is left after -skip " << skip_s << " s: the summary has no errors\n";
    }
    saw_ndt::writeLocalization(folder.path(), run, summary, options.T_base_lidar, T_camera_lidar);
    folder.keep();
    std::cout << saw_ndt::toJsonText(summary);
    if (summary.accepted == 0) {
      throw saw_ndt::Error(sequence_folder, "",
                           "no scan was located in " + map_file +
                               ", the first one for: " + saw_ndt::toString(run.results.front().acceptance));
    }
    if (strict && unreadable > 0) {
      throw saw_ndt::Error(sequence_folder, "", std::to_string(unreadable) + " scans could not be read (-strict)");
    }
  });
}
