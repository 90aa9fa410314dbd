#include "saw_ndt/io/kitti.h"

#include <algorithm>
#include <array>
#include <iomanip>

#include "common/atomic_output.h"
#include "io/bin_scan.h"
#include "io/binary_records.h"
#include "io/kitti_calibration.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {

using namespace internal;

namespace fs = std::filesystem;

namespace {

// Four cameras like those of KITTI's vehicle: what writeKittiCalibration() states where nothing is projected.
constexpr double kFocalLength_px = 720.0;
constexpr double kPrincipalPointX_px = 620.0;
constexpr double kPrincipalPointY_px = 188.0;
constexpr std::array<double, 4> kCameraPlaces_m = {0.0, -0.54, 0.06, -0.48};  // to the left of the left grey one

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

std::vector<LidarPoint> readKittiScan(const fs::path& path) {
  std::vector<LidarPoint> points;
  readKittiScan(path, points);
  return points;
}

void readKittiScan(const fs::path& path, std::vector<LidarPoint>& points) {
  static_assert(sizeof(LidarPoint) == 4 * sizeof(float));
  readRecords(path, points);
  const float* values = &points.front().x;
  const int fields = tellBinFields(values, kKittiFields * points.size()).value_or(kKittiFields);
  if (fields != kKittiFields) {
    throw Error(path.string(), "", "seems to have " + std::to_string(fields) + " float32 a point, where 4 are needed");
  }
  requireScanCoordinates(path, values, kKittiFields * points.size(), kKittiFields);
}

std::vector<std::uint16_t> readSemanticKittiLabels(const fs::path& path) {
  std::vector<std::uint32_t> values;
  readRecords(path, values);
  std::vector<std::uint16_t> classes(values.size());
  std::transform(values.begin(), values.end(), classes.begin(),
                 [](std::uint32_t value) { return static_cast<std::uint16_t>(value & 0xffffU); });
  return classes;
}

void writeKittiScan(const fs::path& path, const std::vector<LidarPoint>& points) { writeRecords(path, points); }

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
  if (const auto Tr = kittiTransform(path, {"Tr"})) return *Tr;
  const auto Tr_unrectified = kittiTransform(path, {"Tr_velo_to_cam", "Tr_velo_cam"});
  if (!Tr_unrectified) throw Error(path.string(), "", "no line Tr (LiDAR to left camera)");
  const auto rectification = kittiRotation(path, {"R0_rect", "R_rect"});
  return rectification.value_or(Eigen::Isometry3d::Identity()) * *Tr_unrectified;
}

}  // namespace saw_ndt
