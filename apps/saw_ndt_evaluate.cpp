#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "app_options.h"
#include "io/staged_output.h"
#include "io/stamp_check.h"
#include "output_folder.h"
#include "report/evaluation_pictures.h"
#include "report/evaluation_report.h"
#include "report/gnuplot.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/io/kitti.h"
#include "saw_ndt/io/trajectory.h"

namespace {

constexpr char kDescription[] =
    "Compares an estimated trajectory with its reference: absolute trajectory error, 95th percentile and maximum of "
    "the "
    "position error, yaw errors, KITTI's relative errors where the drive has 100 m, and the figures of evo's evo_ape "
    "and "
    "evo_rpe. Nothing is aligned unless -align says so. Files are TUM (stamp x y z qx qy qz qw; poses of the LiDAR), "
    "CSV "
    "(the same with commas, or a line of names, in which case names such as stamp_s, x_m, qx or EuRoC's decide) or "
    "KITTI "
    "(12 numbers a line; poses of the left camera), told apart by their commas and columns. Poses of equal stamps (to "
    "within -max-difference) are compared; "
    "poses of one trajectory must have stamps of their own. A KITTI file has no stamps: "
    "without -times two KITTI files are compared line by line, 0.1 s apart, and must have as many lines. With -calib "
    "KITTI poses are converted to LiDAR poses; without it their errors are those of the camera, its axes turned to x "
    "forward, y left, z up. A KITTI file beside another one needs both -times and -calib. Printed are, after the "
    "figures "
    "of position and yaw, ape_*: statistics (sse: sum of squares) of the absolute errors of translation, rotation "
    "(angle) "
    "and both (Frobenius norm); rpe_frames and rpe_metres: the same of relative errors; paired_share: the share of the "
    "estimated poses that have a reference.";

/// T_camera_lidar of a LiDAR at the camera, its axes forward, left, up where the camera's are right, down, forward.
Eigen::Isometry3d nominalCalibration() {
  Eigen::Isometry3d Tr = Eigen::Isometry3d::Identity();
  Tr.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return Tr;
}

struct Files {
  std::string reference;
  std::string estimate;
  std::string times;
  std::string calib;
};

void setStamps(const Files& files, const std::string& path, saw_ndt::Trajectory& trajectory) {
  const std::vector<double> stamps_s = saw_ndt::readStamps(files.times);
  if (stamps_s.size() != trajectory.poses.size()) {
    throw saw_ndt::Error(files.times, "",
                         std::to_string(stamps_s.size()) + " times, where " + path + " has " +
                             std::to_string(trajectory.poses.size()) + " poses");
  }
  for (std::size_t i = 0; i < stamps_s.size(); ++i) trajectory.poses[i].stamp_s = stamps_s[i];
}

/// Reads both files; KITTI poses come back as poses of the LiDAR, or of the camera's position where no -calib is given.
std::pair<saw_ndt::Trajectory, saw_ndt::Trajectory> readTrajectories(const Files& files, bool has_stamp_options) {
  using saw_ndt::TrajectoryFormat;
  std::pair<saw_ndt::Trajectory, saw_ndt::Trajectory> both{saw_ndt::readTrajectory(files.reference),
                                                           saw_ndt::readTrajectory(files.estimate)};
  auto& [reference, estimate] = both;
  const bool both_kitti = reference.format == TrajectoryFormat::KITTI && estimate.format == TrajectoryFormat::KITTI;
  const bool one_kitti =
      !both_kitti && (reference.format == TrajectoryFormat::KITTI || estimate.format == TrajectoryFormat::KITTI);
  if (both_kitti && files.times.empty() && has_stamp_options) {
    throw saw_ndt::UsageError(
        "options -max-difference, -offset and -interpolate need the stamps of the KITTI files: -times FILE");
  }
  if (one_kitti && (files.times.empty() || files.calib.empty())) {
    const std::string& kitti = reference.format == TrajectoryFormat::KITTI ? files.reference : files.estimate;
    throw saw_ndt::UsageError(kitti +
                              " is a KITTI file and the other one has stamps: -times FILE must give its own "
                              "and -calib FILE the calibration of the camera");
  }
  if (both_kitti && reference.poses.size() != estimate.poses.size()) {
    throw saw_ndt::Error(files.estimate, "",
                         std::to_string(estimate.poses.size()) + " poses, where " + files.reference + " has " +
                             std::to_string(reference.poses.size()) +
                             ": KITTI files are compared line by line and must have as many");
  }
  const Eigen::Isometry3d Tr = files.calib.empty() ? nominalCalibration() : saw_ndt::readKittiCalibration(files.calib);
  for (auto [trajectory, path] : {std::pair(&reference, &files.reference), std::pair(&estimate, &files.estimate)}) {
    if (trajectory->format != TrajectoryFormat::KITTI) continue;
    if (!files.times.empty()) setStamps(files, *path, *trajectory);
    for (saw_ndt::StampedPose& pose : trajectory->poses) pose.T_map_body = saw_ndt::lidarPose(pose.T_map_body, Tr);
  }
  return both;
}

/// Says what is odd about the stamps of a trajectory.
void checkStamps(const saw_ndt::AppOptions& app, const Files& files, const std::string& own_file,
                 const saw_ndt::Trajectory& trajectory) {
  const bool has_stamps = trajectory.format != saw_ndt::TrajectoryFormat::KITTI;
  if (!has_stamps && files.times.empty()) return;
  const std::string& file = has_stamps ? own_file : files.times;
  std::vector<double> stamps_s;
  for (const saw_ndt::StampedPose& pose : trajectory.poses) stamps_s.push_back(pose.stamp_s);
  for (const std::string& odd : saw_ndt::internal::oddStamps(stamps_s)) saw_ndt::warn(app, file + ": " + odd);
}

/// Says where few of the poses to be evaluated have a reference.
void checkPairs(const saw_ndt::AppOptions& app, const Files& files, const saw_ndt::PairedTrajectories& paired,
                const saw_ndt::PairingOptions& options) {
  constexpr double kFew = 0.5;
  if (paired.pairedShare() >= kFew) return;
  std::ostringstream reason;
  reason << files.reference << ": only " << paired.paired_estimates << " of " << paired.estimate_poses << " poses of "
         << files.estimate << " have a reference ";
  if (options.interpolate) {
    reason << "between two that are at most " << options.longest_gap_s << " s apart";
  } else {
    reason << "within " << options.max_difference_s << " s";
  }
  saw_ndt::warn(app, reason.str() + "; the errors are of these alone");
}

saw_ndt::TrajectoryAlignment alignmentNamed(const std::string& name) {
  using saw_ndt::TrajectoryAlignment;
  for (const TrajectoryAlignment alignment :
       {TrajectoryAlignment::ORIGIN, TrajectoryAlignment::YAW, TrajectoryAlignment::SE3}) {
    if (name == toString(alignment)) return alignment;
  }
  return TrajectoryAlignment::NONE;
}

/// What relative errors are asked for.
struct RelativeArguments {
  double frames = 0.0;
  double metres = 0.0;
  bool all_pairs = false;
  bool way_of_reference = false;
  double tolerance = saw_ndt::RelativeErrorOptions().relative_tolerance;

  /// Nothing where `delta`, the value of `option`, is 0. @throws UsageError
  std::optional<saw_ndt::RelativeErrorOptions> options(const std::string& option,
                                                       saw_ndt::RelativeErrorOptions::Unit unit, double delta) const {
    if (delta == 0.0) return std::nullopt;
    saw_ndt::RelativeErrorOptions options;
    options.unit = unit;
    options.delta = delta;
    options.all_pairs = all_pairs;
    options.way_of_reference = way_of_reference;
    options.relative_tolerance = tolerance;
    try {
      options.check();
    } catch (const std::invalid_argument& error) {
      throw saw_ndt::UsageError("option -" + option + ": " + error.what());
    }
    return options;
  }
};

void checkUsage(const saw_ndt::AppOptions& app, const saw_ndt::PairingOptions& pairing,
                const RelativeArguments& relative, const std::string& picture_folder) {
  if (pairing.skip_s < 0.0) throw saw_ndt::UsageError("option -skip: must be 0 or greater");
  if (pairing.max_difference_s < 0.0) throw saw_ndt::UsageError("option -max-difference: must be 0 or greater");
  if (!(pairing.longest_gap_s > 0.0)) throw saw_ndt::UsageError("option -longest-gap: must be positive");
  if (pairing.interpolate && app.isGiven("max-difference")) {
    throw saw_ndt::UsageError("options -interpolate and -max-difference exclude each other");
  }
  if (!pairing.interpolate && app.isGiven("longest-gap")) {
    throw saw_ndt::UsageError("option -longest-gap: is for -interpolate alone");
  }
  for (const char* name : {"all-pairs", "way-of-reference", "relative-tolerance"}) {
    if (app.isGiven(name) && relative.frames == 0.0 && relative.metres == 0.0) {
      throw saw_ndt::UsageError(std::string("option -") + name +
                                ": is for -relative-frames and -relative-metres alone");
    }
  }
  if (!picture_folder.empty() && !saw_ndt::gnuplotFound()) {
    throw saw_ndt::UsageError("option -plot: the program gnuplot is not installed (Debian: apt install gnuplot-nox)");
  }
}

void drawPictures(const saw_ndt::TrajectoryEvaluation& evaluation, const std::string& folder_name) {
  saw_ndt::OutputFolder folder(folder_name);
  saw_ndt::internal::StagedOutput staged(folder.path());
  for (const saw_ndt::GnuplotPicture& picture : saw_ndt::evaluationPictures(evaluation)) {
    saw_ndt::drawPicture(picture, staged.folder());
  }
  staged.commit();
  folder.keep();
}

}  // namespace

int main(int argc, char** argv) {
  Files files;
  saw_ndt::PairingOptions pairing;
  pairing.skip_s = 3.0;
  RelativeArguments relative;
  std::string align = "none", picture_folder;
  bool as_json = false;
  saw_ndt::AppOptions app("saw_ndt_evaluate", kDescription);
  app.addPositional("REFERENCE", &files.reference, "reference trajectory, TUM, CSV or KITTI");
  app.addPositional("ESTIMATE", &files.estimate, "estimated trajectory, TUM, CSV or KITTI");
  app.addOption("skip", &pairing.skip_s, "SECONDS", "time left out at the start, from the first stamp of ESTIMATE");
  app.addFlag("json", &as_json, "print one JSON object");
  app.addOption("times", &files.times, "FILE", "stamps in seconds of the KITTI files, one a line as in times.txt");
  app.addOption("calib", &files.calib, "FILE", "calib.txt with Tr (LiDAR to left camera) of the KITTI files");
  app.addChoice("align", &align, {"none", "origin", "yaw", "se3"},
                "what is put before ESTIMATE first: what makes its first pose the reference's (origin), or what brings "
                "its positions nearest: translation and turn about z (yaw), or translation and rotation (se3)");
  app.addOption("max-difference", &pairing.max_difference_s, "SECONDS", "greatest difference of two stamps of a pair");
  app.addOption("offset", &pairing.offset_s, "SECONDS", "added to the stamps of ESTIMATE");
  app.addFlag("interpolate", &pairing.interpolate,
              "compare every pose of ESTIMATE with the reference at its own moment, between two of REFERENCE");
  app.addOption("longest-gap", &pairing.longest_gap_s, "SECONDS", "greatest time between two such poses of REFERENCE");
  app.addOption("relative-frames", &relative.frames, "POSES",
                "relative errors between poses so many pairs apart; 0: none");
  app.addOption("relative-metres", &relative.metres, "METRES",
                "relative errors between poses so long a way apart; 0: none");
  app.addFlag("all-pairs", &relative.all_pairs,
              "relative errors from every pose, not only from where the last one ended");
  app.addFlag("way-of-reference", &relative.way_of_reference,
              "metres are those of the reference's way, not of the estimate's");
  app.addOption("relative-tolerance", &relative.tolerance, "SHARE",
                "how far off -relative-metres the way may be with -all-pairs");
  app.addOption("plot", &picture_folder, "DIR",
                "draw pictures (PNG and SVG) of the trajectories and of the errors over time; needs gnuplot");

  return saw_ndt::runApp(argc, argv, app, [&] {
    using Unit = saw_ndt::RelativeErrorOptions::Unit;
    checkUsage(app, pairing, relative, picture_folder);
    const auto by_frames = relative.options("relative-frames", Unit::FRAMES, relative.frames);
    const auto by_metres = relative.options("relative-metres", Unit::METRES, relative.metres);
    const auto [reference, estimate] =
        readTrajectories(files, app.isGiven("max-difference") || app.isGiven("offset") || app.isGiven("interpolate"));
    checkStamps(app, files, files.reference, reference);
    checkStamps(app, files, files.estimate, estimate);
    saw_ndt::PairedTrajectories paired = saw_ndt::pairTrajectories(reference.poses, estimate.poses, pairing);
    checkPairs(app, files, paired, pairing);
    const saw_ndt::TrajectoryEvaluation evaluation =
        saw_ndt::evaluated(std::move(paired), pairing, alignmentNamed(align), by_frames, by_metres);
    if (!picture_folder.empty()) drawPictures(evaluation, picture_folder);
    const nlohmann::ordered_json report = saw_ndt::toJson(evaluation);
    if (as_json) {
      std::cout << report.dump(2) << '\n';
    } else {
      saw_ndt::writeText(report, std::cout);
    }
  });
}
