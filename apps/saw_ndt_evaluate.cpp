#include <algorithm>
#include <iomanip>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app_options.h"
#include "io/stamp_check.h"
#include "report/json.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/io/kitti.h"
#include "saw_ndt/io/trajectory.h"

namespace {

constexpr char kDescription[] =
    "Compares an estimated trajectory with its reference, nothing aligned: absolute trajectory error, 95th percentile "
    "and maximum of the position error, yaw errors, and KITTI's relative errors where the drive has 100 m. Files are "
    "TUM (stamp x y z qx qy qz qw; poses of the LiDAR) or KITTI (12 numbers a line; poses of the left camera), told "
    "apart by their columns. Poses of equal stamps (to within 10 ms) are compared; "
    "poses of one trajectory must have stamps of their own. A KITTI file has no stamps: "
    "without -times two KITTI files are compared line by line, 0.1 s apart, and must have as many lines. With -calib "
    "KITTI poses are converted to LiDAR poses; without it their errors are those of the camera, its axes turned to x "
    "forward, y left, z up. A KITTI file beside a TUM file needs both -times and -calib.";

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
std::pair<saw_ndt::Trajectory, saw_ndt::Trajectory> readTrajectories(const Files& files) {
  using saw_ndt::TrajectoryFormat;
  std::pair<saw_ndt::Trajectory, saw_ndt::Trajectory> both{saw_ndt::readTrajectory(files.reference),
                                                           saw_ndt::readTrajectory(files.estimate)};
  auto& [reference, estimate] = both;
  if (reference.format != estimate.format && (files.times.empty() || files.calib.empty())) {
    const std::string& kitti = reference.format == TrajectoryFormat::KITTI ? files.reference : files.estimate;
    throw saw_ndt::UsageError(kitti +
                              " is a KITTI file and the other one a TUM file: -times FILE must give its stamps "
                              "and -calib FILE the calibration of the camera");
  }
  if (reference.format == TrajectoryFormat::KITTI && estimate.format == TrajectoryFormat::KITTI &&
      reference.poses.size() != estimate.poses.size()) {
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
  const bool has_stamps = trajectory.format == saw_ndt::TrajectoryFormat::TUM;
  if (!has_stamps && files.times.empty()) return;
  const std::string& file = has_stamps ? own_file : files.times;
  std::vector<double> stamps_s;
  for (const saw_ndt::StampedPose& pose : trajectory.poses) stamps_s.push_back(pose.stamp_s);
  for (const std::string& odd : saw_ndt::internal::oddStamps(stamps_s)) saw_ndt::warn(app, file + ": " + odd);
}

/// Says where few of the poses to be evaluated have a reference.
void checkPairs(const saw_ndt::AppOptions& app, const Files& files, const saw_ndt::Trajectory& estimate,
                std::size_t pairs, double skip_s) {
  constexpr double kFew = 0.5;
  double first_s = estimate.poses.front().stamp_s;
  for (const saw_ndt::StampedPose& pose : estimate.poses) first_s = std::min(first_s, pose.stamp_s);
  const auto poses = static_cast<std::size_t>(
      std::count_if(estimate.poses.begin(), estimate.poses.end(),
                    [&](const saw_ndt::StampedPose& pose) { return pose.stamp_s - first_s >= skip_s; }));
  if (static_cast<double>(pairs) >= kFew * static_cast<double>(poses)) return;
  std::ostringstream tolerance;
  tolerance << saw_ndt::kStampTolerance_s;
  saw_ndt::warn(app, files.reference + ": only " + std::to_string(pairs) + " of " + std::to_string(poses) +
                         " poses of " + files.estimate + " have a reference within " + tolerance.str() +
                         " s; the errors are of these alone");
}

}  // namespace

int main(int argc, char** argv) {
  Files files;
  double skip_s = 3.0;
  bool as_json = false;
  saw_ndt::AppOptions app("saw_ndt_evaluate", kDescription);
  app.addPositional("REFERENCE", &files.reference, "reference trajectory, TUM or KITTI");
  app.addPositional("ESTIMATE", &files.estimate, "estimated trajectory, TUM or KITTI");
  app.addOption("skip", &skip_s, "SECONDS", "time left out at the start, from the first stamp of ESTIMATE");
  app.addFlag("json", &as_json, "print one JSON object");
  app.addOption("times", &files.times, "FILE", "stamps in seconds of the KITTI files, one a line as in times.txt");
  app.addOption("calib", &files.calib, "FILE", "calib.txt with Tr (LiDAR to left camera) of the KITTI files");

  return saw_ndt::runApp(argc, argv, app, [&] {
    if (skip_s < 0.0) throw saw_ndt::UsageError("option -skip: must be 0 or greater");
    const auto [reference, estimate] = readTrajectories(files);
    checkStamps(app, files, files.reference, reference);
    checkStamps(app, files, files.estimate, estimate);
    const auto pairs = saw_ndt::matchTrajectories(reference.poses, estimate.poses, skip_s);
    checkPairs(app, files, estimate, pairs.size(), skip_s);
    nlohmann::ordered_json report = saw_ndt::toJson(saw_ndt::evaluatePosePairs(pairs));
    if (const auto relative = saw_ndt::kittiRelativeErrors(pairs)) report.update(saw_ndt::toJson(*relative));
    if (as_json) {
      std::cout << report.dump(2) << '\n';
      return;
    }
    for (const auto& [name, value] : report.items()) std::cout << std::left << std::setw(26) << name << value << '\n';
  });
}
