#include "simulation/sequence_writer.h"

#include <future>
#include <iomanip>
#include <locale>
#include <sstream>
#include <stdexcept>
#include <string>

#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/io/kitti.h"
#include "saw_ndt/io/trajectory.h"

namespace saw_ndt {

namespace fs = std::filesystem;

namespace {

void makeFolder(const fs::path& folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) throw Error(folder.string(), "", failure.message());
}

void writeScan(const fs::path& folder, int number, const LidarScan& scan) {
  std::ostringstream stem;
  stem.imbue(std::locale::classic());
  stem << std::setw(6) << std::setfill('0') << number;
  writeKittiScan(folder / "velodyne" / (stem.str() + ".bin"), scan.points);
  writeSemanticKittiLabels(folder / "labels" / (stem.str() + ".label"), scan.semantic_classes);
}

std::vector<Eigen::Isometry3d> cameraPoses(const std::vector<Eigen::Isometry3d>& T_scene_lidar,
                                           const Eigen::Isometry3d& T_camera_lidar) {
  std::vector<Eigen::Isometry3d> poses;
  for (const Eigen::Isometry3d& T : T_scene_lidar) poses.push_back(cameraPose(T, T_camera_lidar));
  return poses;
}

bool differ(const std::vector<Eigen::Isometry3d>& a, const std::vector<Eigen::Isometry3d>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].affine() != b[i].affine()) return true;
  }
  return false;
}

}  // namespace

Eigen::Isometry3d simulatedCalibration() {
  // The camera looks along its z axis, x to the right.
  Eigen::Matrix3d R_level_camera_lidar;
  R_level_camera_lidar << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  const Eigen::Vector3d mounting_rad(radiansFromDegrees(-0.4), radiansFromDegrees(0.25), radiansFromDegrees(0.15));
  Eigen::Isometry3d T_camera_lidar = Eigen::Isometry3d::Identity();
  T_camera_lidar.linear() = rotationFromVector(mounting_rad) * R_level_camera_lidar;
  T_camera_lidar.translation() = -(T_camera_lidar.linear() * Eigen::Vector3d(0.27, 0.0, -0.08));
  return T_camera_lidar;
}

SequenceContent writeSequence(const fs::path& folder, LidarSimulator& simulator, const VehicleMotion& motion,
                              const std::vector<Eigen::Isometry3d>& reference, const std::function<void()>& progress) {
  checkOption(motion.scanCount() > 0, "motion.scanCount()", motion.scanCount(), "1 or more");
  checkOption(motion.T_scene_lidar.size() == motion.stamps_s.size(), "motion.T_scene_lidar.size()",
              motion.T_scene_lidar.size(), "that of stamps_s");
  checkOption(reference.empty() || reference.size() == motion.stamps_s.size(), "reference.size()", reference.size(),
              "0 or the number of scans");
  makeFolder(folder / "velodyne");
  makeFolder(folder / "labels");

  const Eigen::Isometry3d T_camera_lidar = simulatedCalibration();
  writeKittiCalibration(folder / "calib.txt", T_camera_lidar);
  writeStamps(folder / "times.txt", motion.stamps_s);
  const bool has_errors = !reference.empty() && differ(reference, motion.T_scene_lidar);
  writeKittiTrajectory(folder / "poses.txt",
                       cameraPoses(has_errors ? reference : motion.T_scene_lidar, T_camera_lidar));
  if (has_errors) writeKittiTrajectory(folder / "poses_true.txt", cameraPoses(motion.T_scene_lidar, T_camera_lidar));

  SequenceContent content;
  std::future<void> writing;  // of the scan before, while the next one is cast
  for (int number = 0; number < motion.scanCount(); ++number) {
    LidarScan scan = simulator.scan(motion, number);
    ++content.scan_count;
    content.point_count += scan.points.size();
    if (writing.valid()) writing.get();
    writing =
        std::async(std::launch::async, [&folder, number, scan = std::move(scan)] { writeScan(folder, number, scan); });
    if (progress) progress();
  }
  writing.get();
  return content;
}

}  // namespace saw_ndt
