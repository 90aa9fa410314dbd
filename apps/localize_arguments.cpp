#include "localize_arguments.h"

#include "pose_argument.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {
namespace {

// An uncertainty is given as how far it reaches.
constexpr double kSigmas = 3.0;
constexpr char kUnknown[] = "unknown";

}  // namespace

void LocalizeArguments::addTo(AppOptions& app) {
  initial_radius_m_ = kSigmas * options.prediction.initial_sigma_m;
  initial_yaw_range_deg_ = kSigmas * options.prediction.initial_sigma_deg;
  method_ = options.method.name;
  app.addPositional("SEQUENCE", &sequence,
                    std::string(RecordingArgument::kKinds) +
                        "; or a live source: a folder that grows (-follow), or a Velodyne's packets, udp:PORT or "
                        "udp:ADDRESS:PORT");
  app.addPositional(
      "MAP", &map_file,
      "map file of saw_ndt_build_map or, of which the tiles around the vehicle alone are held, of saw_ndt_map_pack");
  app.addPositional("OUT_DIR", &out_dir, "folder for the results, made where it is missing");
  app.addChoice("method", &method_, LocalizationMethod::names(),
                "weighted is this project's, the others are the paper's");
  app.addOption("scans", &scans, "SLICE", "scans to localize, first:last:step as in Python: `1:70:2`, or all with `:`");
  app.addOption("skip", &skip_s, "SECONDS", "time at the start that the errors leave out; 0 for short drives");
  app.addFlag("follow", &follow,
              "SEQUENCE is a folder into which scans are written: go on with them until interrupted (Ctrl-C, SIGTERM)");
  app.addOption("max-waiting", &max_waiting, "N",
                "scans of a live source that may wait while one is localized; where more do, all but the newest are "
                "left out");
  app.addOption("stream", &stream_file, "FILE",
                "write each pose as it is found, with state and standard deviations, into a file, a pipe or, with -, "
                "to stdout");
  app.addChoice("stream-format", &stream_format, {"json", "tum"},
                "json: an object a line; tum: a line of TUM format, the rest in a comment before it");
  app.addOption("initial-pose", &initial_pose, kPosePlaceholder,
                "pose of the base in the map at the first scan, metres and degrees, or `unknown`: it is looked for in "
                "all of the map (default: its reference pose)");
  app.addOption("initial-radius", &initial_radius_m_, "METRES", "how far from there the base may be");
  app.addOption("initial-yaw-range", &initial_yaw_range_deg_, "DEGREES",
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
  app.addOption(
      "map-radius", &options.tiles.radius_m, "METRES",
      "how far around the vehicle tiles of a map of saw_ndt_map_pack are held; points of scans that lie farther "
      "away are left out");
  app.addOption("map-memory", &map_memory_mb, "MB",
                "for the voxels around one place at most; where that is less than needed, fewer tiles are held");
  app.addFlag("no-search", &no_search_, "do not look for a pose that is lost, but align from predictions alone");
  app.addOption("base-lidar", &base_lidar_, kPosePlaceholder,
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
  motion.addTo(app);
  app.addFlag("strict", &strict, "a scan that cannot be read makes the run a failure; the results are written");
  recording.addTo(app);
  segmentation.addTo(app);
  app.addFlag("allow-other-segmentation", &options.allow_other_segmentation,
              "go on where the scans of the map were segmented by other options, as those of another LiDAR");
}

void LocalizeArguments::check(const AppOptions& app) {
  if (skip_s < 0.0) throw UsageError("option -skip: must be 0 or greater");
  options.method = LocalizationMethod::named(method_);
  options.segmentation = segmentation.stated();
  options.alignment.threads = app.threads();
  options.T_base_lidar = transformOf(base_lidar_);
  options.search = !no_search_;
  options.prediction.initial_sigma_m = initial_radius_m_ / kSigmas;
  options.prediction.initial_sigma_deg = initial_yaw_range_deg_ / kSigmas;
  checkedUsage([&] {
    checkOption(initial_radius_m_ > 0.0, "initial-radius", initial_radius_m_, "positive");
    checkOption(initial_yaw_range_deg_ > 0.0 && initial_yaw_range_deg_ <= 180.0, "initial-yaw-range",
                initial_yaw_range_deg_, "positive and at most 180");
    checkOption(map_memory_mb >= 1.0 && map_memory_mb <= 1e6, "map-memory", map_memory_mb, "1 to 1000000");
    options.tiles.most_bytes = static_cast<std::size_t>(map_memory_mb * 1e6);
    checkOption(max_waiting >= 1, "max-waiting", max_waiting, "1 or more");
    checkOption(gnss_sigma_m > 0.0, "gnss-sigma", gnss_sigma_m, "positive");
    checkOption(drift.share >= 0.0, "odometry-drift", drift.share, "0 or more");
    checkOption(drift.deg_per_s >= 0.0, "odometry-drift-deg", drift.deg_per_s, "0 or more");
    options.check();
  });
  if (no_search_ && initial_pose == kUnknown) throw UsageError("option -initial-pose unknown: excludes -no-search");
  statedInitialPose();
}

std::optional<Eigen::Isometry3d> LocalizeArguments::statedInitialPose() const {
  if (initial_pose.empty() || initial_pose == kUnknown) return std::nullopt;
  return transformOf(parseNumbers("initial-pose", initial_pose, 6));
}

}  // namespace saw_ndt
