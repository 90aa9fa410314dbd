#include "saw_ndt/drives/kitti_sequence.h"

#include <cerrno>
#include <cstring>

#include "drives/numbered_files.h"
#include "io/bin_scan.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/io/kitti.h"
#include "saw_ndt/io/scan_file.h"
#include "saw_ndt/io/trajectory.h"

namespace saw_ndt {

using namespace internal;

namespace fs = std::filesystem;

namespace {

constexpr char kTimesFile[] = "times.txt";

fs::path withoutTrailingSlash(const fs::path& folder) { return folder.has_filename() ? folder : folder.parent_path(); }

/// Where the poses of a sequence lie, its path being free of links to parents.
fs::path posesBeside(const fs::path& sequence) {
  return sequence.parent_path().parent_path() / "poses" / (sequence.filename().string() + ".txt");
}

}  // namespace

KittiSequence::KittiSequence(const fs::path& folder, const fs::path& poses_file, int bin_fields)
    : Recording(folder, withoutTrailingSlash(fs::absolute(folder).lexically_normal()).filename().string()),
      bin_fields_(bin_fields) {
  requireBinFields(bin_fields);
  const fs::path velodyne = folder / "velodyne";
  for (const fs::path& needed : {folder, velodyne}) {
    if (!fs::exists(needed)) throw Error(needed.string(), "", std::strerror(ENOENT));
    if (!fs::is_directory(needed)) throw Error(needed.string(), "", std::strerror(ENOTDIR));
  }
  for (const NumberedFile& file : numberedFiles(velodyne, ".bin")) {
    scans_.push_back({file.number, file.path.stem().string()});
  }
  if (scans_.empty()) throw Error(velodyne.string(), "", "holds no numbered .bin file");

  const fs::path as_given = withoutTrailingSlash(fs::absolute(folder).lexically_normal());
  const fs::path as_is = fs::weakly_canonical(as_given);
  if (!poses_file.empty()) {
    if (!fs::exists(poses_file)) throw Error(poses_file.string(), "", std::strerror(ENOENT));
    poses_file_ = poses_file;
    return;
  }
  for (const fs::path& candidate : {folder / "poses.txt", posesBeside(as_given), posesBeside(as_is)}) {
    if (fs::exists(candidate)) {
      poses_file_ = candidate;
      return;
    }
  }
}

const KittiSequence::Scan& KittiSequence::scanAt(int scan) const { return scans_[requireScan(scan)]; }

fs::path KittiSequence::scanPath(int scan) const { return folder() / "velodyne" / (scanAt(scan).stem + ".bin"); }

std::string KittiSequence::scanName(int scan) const { return scanAt(scan).stem + ".bin"; }

fs::path KittiSequence::labelPath(int scan) const { return folder() / "labels" / (scanAt(scan).stem + ".label"); }

std::vector<LidarPoint> KittiSequence::readScan(int scan) const {
  ScanPoints points;
  readScan(scan, points);
  return std::move(points.points);
}

void KittiSequence::readScan(int scan, ScanPoints& points) const {
  readScanPoints(scanPath(scan), points, binFields());
}

int KittiSequence::binFields() const {
  if (bin_fields_ != 0) return bin_fields_;
  std::vector<fs::path> paths;
  for (int scan = 0; scan < scanCount(); ++scan) paths.push_back(scanPath(scan));
  bin_fields_ = binFieldsOfScans(paths);
  return bin_fields_;
}

std::vector<std::uint16_t> KittiSequence::readLabels(int scan) const {
  std::vector<std::uint16_t> classes = readSemanticKittiLabels(labelPath(scan));
  const std::uintmax_t points =
      fs::file_size(scanPath(scan)) / (static_cast<std::uintmax_t>(binFields()) * sizeof(float));
  if (classes.size() != points) {
    throw Error(labelPath(scan).string(), "",
                std::to_string(classes.size()) + " labels, where the scan has " + std::to_string(points) + " points");
  }
  return classes;
}

std::vector<std::size_t> KittiSequence::linesOfScans(const fs::path& path, const std::string& what,
                                                     std::size_t line_count) const {
  const bool by_position = line_count <= scans_.size();
  const unsigned long long needed = by_position ? scans_.size() : linesUpTo(scans_.back().number);
  if (line_count < needed) {
    throw Error(path.string(), "",
                std::to_string(line_count) + " " + what + ", where the scans need " + std::to_string(needed));
  }
  std::vector<std::size_t> lines;
  for (std::size_t i = 0; i < scans_.size(); ++i) lines.push_back(by_position ? i : scans_[i].number);
  return lines;
}

bool KittiSequence::hasStamps() const { return fs::exists(folder() / kTimesFile); }

std::string KittiSequence::stampsPlace() const { return (folder() / kTimesFile).string(); }

const std::vector<double>& KittiSequence::stamps() const {
  if (!stamps_s_.empty()) return stamps_s_;
  const fs::path path = folder() / kTimesFile;
  const std::vector<double> all_s = readStamps(path);
  for (const std::size_t line : linesOfScans(path, "times", all_s.size())) stamps_s_.push_back(all_s[line]);
  return stamps_s_;
}

Eigen::Isometry3d KittiSequence::T_camera_lidar() const { return readKittiCalibration(folder() / "calib.txt"); }

const std::vector<Eigen::Isometry3d>& KittiSequence::posesLidar() const {
  if (!T_map_lidar_.empty()) return T_map_lidar_;
  if (!hasPoses()) {
    throw Error((folder() / "poses.txt").string(), "",
                "no poses: neither this file nor ../../poses/" + name() + ".txt exists");
  }
  const std::vector<Eigen::Isometry3d> camera_poses = readKittiTrajectory(poses_file_);
  const std::vector<std::size_t> lines = linesOfScans(poses_file_, "poses", camera_poses.size());
  const Eigen::Isometry3d Tr = T_camera_lidar();
  for (const std::size_t line : lines) T_map_lidar_.push_back(lidarPose(camera_poses[line], Tr));
  return T_map_lidar_;
}

std::optional<Eigen::Isometry3d> KittiSequence::referencePose(int scan) const {
  return posesLidar()[requireScan(scan)];
}

}  // namespace saw_ndt
