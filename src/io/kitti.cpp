#include "saw_ndt/io/kitti.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <iomanip>
#include <stdexcept>

#include "io/number_lines.h"
#include "io/rigid_transform.h"
#include "saw_ndt/common/error.h"
#include "common/atomic_output.h"
#include "common/input_file.h"
#include "saw_ndt/io/trajectory.h"

namespace saw_ndt {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kBytesPerPoint = 4 * sizeof(float);

// Four cameras like those of KITTI's vehicle: what writeKittiCalibration() states where nothing is projected.
constexpr double kFocalLength_px = 720.0;
constexpr double kPrincipalPointX_px = 620.0;
constexpr double kPrincipalPointY_px = 188.0;
constexpr std::array<double, 4> kCameraPlaces_m = {0.0, -0.54, 0.06, -0.48};  // to the left of the left grey one

/// The records of a binary file without a header; Error unless there is at least one and the last one is whole.
template <typename Value>
std::vector<Value> readRecords(const fs::path& path, std::size_t record_bytes) {
  std::ifstream stream = openInputFile(path);
  stream.seekg(0, std::ios::end);
  const std::streamoff end = stream.tellg();
  if (end < 0) throw Error(path.string(), "", "its size cannot be told");
  const auto size = static_cast<std::size_t>(end);
  if (size == 0) throw Error(path.string(), "offset 0", "the file is empty");
  if (size % record_bytes != 0) {
    throw Error(path.string(), "offset " + std::to_string(size - size % record_bytes),
                "the last point is cut short: " + std::to_string(size) + " bytes is no multiple of " +
                    std::to_string(record_bytes));
  }
  std::vector<Value> values(size / sizeof(Value));
  stream.seekg(0);
  stream.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(size));
  if (!stream) throw Error(path.string(), "offset " + std::to_string(stream.gcount()), "could not be read on");
  return values;
}

template <typename Value>
void writeRecords(const fs::path& path, const std::vector<Value>& values) {
  AtomicOutput output(path);
  output.stream().write(reinterpret_cast<const char*>(values.data()),
                        static_cast<std::streamsize>(values.size() * sizeof(Value)));
  output.commit();
}

void writeMatrix(std::ostream& stream, const char* key, const Eigen::Matrix<double, 3, 4>& matrix) {
  stream << key << ':';
  for (int i = 0; i < 12; ++i) stream << ' ' << matrix(i / 4, i % 4);
  stream << '\n';
}

}  // namespace

pcl::PointCloud<pcl::PointXYZI> readKittiScan(const fs::path& path) {
  const std::vector<float> values = readRecords<float>(path, kBytesPerPoint);
  pcl::PointCloud<pcl::PointXYZI> cloud;
  cloud.resize(values.size() / 4);
  cloud.is_dense = true;
  const float* value = values.data();
  for (pcl::PointXYZI& point : cloud) {
    point.x = value[0];
    point.y = value[1];
    point.z = value[2];
    point.intensity = value[3];
    value += 4;
    cloud.is_dense = cloud.is_dense && std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z);
  }
  return cloud;
}

std::vector<std::uint16_t> readSemanticKittiLabels(const fs::path& path) {
  const std::vector<std::uint32_t> values = readRecords<std::uint32_t>(path, sizeof(std::uint32_t));
  std::vector<std::uint16_t> classes(values.size());
  std::transform(values.begin(), values.end(), classes.begin(),
                 [](std::uint32_t value) { return static_cast<std::uint16_t>(value & 0xffffU); });
  return classes;
}

void writeKittiScan(const fs::path& path, const pcl::PointCloud<pcl::PointXYZI>& scan) {
  std::vector<float> values;
  values.reserve(4 * scan.size());
  for (const pcl::PointXYZI& point : scan) {
    values.insert(values.end(), {point.x, point.y, point.z, point.intensity});
  }
  writeRecords(path, values);
}

void writeSemanticKittiLabels(const fs::path& path, const std::vector<std::uint16_t>& classes) {
  writeRecords(path, std::vector<std::uint32_t>(classes.begin(), classes.end()));
}

void writeKittiCalibration(const fs::path& path, const Eigen::Isometry3d& T_camera_lidar) {
  AtomicOutput output(path);
  output.stream() << std::scientific << std::setprecision(12);
  Eigen::Matrix<double, 3, 4> P;
  P << kFocalLength_px, 0.0, kPrincipalPointX_px, 0.0, 0.0, kFocalLength_px, kPrincipalPointY_px, 0.0, 0.0, 0.0, 1.0,
      0.0;
  for (std::size_t camera = 0; camera < kCameraPlaces_m.size(); ++camera) {
    P(0, 3) = kFocalLength_px * kCameraPlaces_m[camera];
    writeMatrix(output.stream(), ("P" + std::to_string(camera)).c_str(), P);
  }
  writeMatrix(output.stream(), "Tr", T_camera_lidar.matrix().topRows<3>());
  output.commit();
}

Eigen::Isometry3d readKittiCalibration(const fs::path& path) {
  for (const TextLine& line : readTextLines(path)) {
    const std::size_t colon = line.text.find(':');
    const std::string key = line.text.substr(0, colon);
    if (key != "Tr" && key != "Tr_velo_to_cam" && key != "Tr_velo_cam") continue;
    if (colon == std::string::npos) throw Error(path.string(), linePlace(line.number), "no ':' after " + key);
    return rigidTransform(path, line.number, parseNumbers(path, line.number, line.text.substr(colon + 1)));
  }
  throw Error(path.string(), "", "no line Tr (LiDAR to left camera)");
}

KittiSequence::KittiSequence(const fs::path& folder, const fs::path& poses_file) : folder_(folder) {
  const fs::path velodyne = folder / "velodyne";
  for (const fs::path& needed : {folder, velodyne}) {
    if (!fs::exists(needed)) throw Error(needed.string(), "", std::strerror(ENOENT));
    if (!fs::is_directory(needed)) throw Error(needed.string(), "", std::strerror(ENOTDIR));
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(velodyne)) {
    if (entry.path().extension() != ".bin") continue;
    Scan scan{0, entry.path().stem().string()};
    const char* end = scan.stem.data() + scan.stem.size();
    const auto [last, error] = std::from_chars(scan.stem.data(), end, scan.number);
    if (error == std::errc() && last == end) scans_.push_back(scan);
  }
  if (scans_.empty()) throw Error(velodyne.string(), "", "holds no numbered .bin file");
  std::sort(scans_.begin(), scans_.end(), [](const Scan& a, const Scan& b) { return a.number < b.number; });

  const fs::path absolute = fs::weakly_canonical(fs::absolute(folder / "."));
  name_ = absolute.has_filename() ? absolute.filename().string() : absolute.parent_path().filename().string();
  if (!poses_file.empty()) {
    if (!fs::exists(poses_file)) throw Error(poses_file.string(), "", std::strerror(ENOENT));
    poses_file_ = poses_file;
    return;
  }
  for (const fs::path& candidate : {folder / "poses.txt", folder / ".." / ".." / "poses" / (name_ + ".txt")}) {
    if (fs::exists(candidate)) {
      poses_file_ = candidate;
      return;
    }
  }
}

const KittiSequence::Scan& KittiSequence::scanAt(int scan) const {
  if (scan < 0 || scan >= scanCount()) {
    throw std::out_of_range("scan " + std::to_string(scan) + ": " + folder_.string() + " has scans 0 to " +
                            std::to_string(scanCount() - 1));
  }
  return scans_[static_cast<std::size_t>(scan)];
}

fs::path KittiSequence::scanPath(int scan) const { return folder_ / "velodyne" / (scanAt(scan).stem + ".bin"); }

fs::path KittiSequence::labelPath(int scan) const { return folder_ / "labels" / (scanAt(scan).stem + ".label"); }

pcl::PointCloud<pcl::PointXYZI> KittiSequence::readScan(int scan) const { return readKittiScan(scanPath(scan)); }

std::vector<std::uint16_t> KittiSequence::readLabels(int scan) const {
  std::vector<std::uint16_t> classes = readSemanticKittiLabels(labelPath(scan));
  const std::uintmax_t points = fs::file_size(scanPath(scan)) / kBytesPerPoint;
  if (classes.size() != points) {
    throw Error(labelPath(scan).string(), "",
                std::to_string(classes.size()) + " labels, where the scan has " + std::to_string(points) + " points");
  }
  return classes;
}

std::vector<std::size_t> KittiSequence::linesOfScans(const fs::path& path, const std::string& what,
                                                     std::size_t line_count) const {
  const bool by_position = line_count <= scans_.size();
  const std::size_t needed = by_position ? scans_.size() : static_cast<std::size_t>(scans_.back().number) + 1;
  if (line_count < needed) {
    throw Error(path.string(), "",
                std::to_string(line_count) + " " + what + ", where the scans need " + std::to_string(needed));
  }
  std::vector<std::size_t> lines;
  for (std::size_t i = 0; i < scans_.size(); ++i) lines.push_back(by_position ? i : scans_[i].number);
  return lines;
}

std::vector<double> KittiSequence::stamps() const {
  const fs::path path = folder_ / "times.txt";
  const std::vector<double> all_s = readStamps(path);
  std::vector<double> stamps_s;
  for (const std::size_t line : linesOfScans(path, "times", all_s.size())) stamps_s.push_back(all_s[line]);
  return stamps_s;
}

Eigen::Isometry3d KittiSequence::T_camera_lidar() const { return readKittiCalibration(folder_ / "calib.txt"); }

std::vector<Eigen::Isometry3d> KittiSequence::posesLidar() const {
  if (!hasPoses()) {
    throw Error((folder_ / "poses.txt").string(), "",
                "no poses: neither this file nor ../../poses/" + name_ + ".txt exists");
  }
  const std::vector<Eigen::Isometry3d> camera_poses = readKittiTrajectory(poses_file_);
  const std::vector<std::size_t> lines = linesOfScans(poses_file_, "poses", camera_poses.size());
  const Eigen::Isometry3d Tr = T_camera_lidar();
  std::vector<Eigen::Isometry3d> poses;
  for (const std::size_t line : lines) poses.push_back(lidarPose(camera_poses[line], Tr));
  return poses;
}

}  // namespace saw_ndt
