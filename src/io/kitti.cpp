#include "saw_ndt/io/kitti.h"

#include <algorithm>
#include <array>
#include <iomanip>
#include <optional>
#include <string_view>
#include <utility>

#include "common/atomic_output.h"
#include "io/bin_scan.h"
#include "io/binary_records.h"
#include "io/number_lines.h"
#include "io/rigid_transform.h"
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

/// The first word of a line, and what follows it and a colon behind it.
std::pair<std::string_view, std::string_view> splitAtKey(std::string_view line) {
  constexpr std::string_view kBlanks = " \t";
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  const std::string_view key = line.substr(0, line.find_first_of(" \t:"));
  line.remove_prefix(key.size());
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  if (!line.empty() && line.front() == ':') line.remove_prefix(1);
  return {key, line};
}

/// The rotation whose matrix is given row by row.
Eigen::Isometry3d rotation(const fs::path& path, std::size_t line, const std::vector<double>& values) {
  if (values.size() != 9) {
    throw Error(path.string(), linePlace(line), std::to_string(values.size()) + " numbers, where 9 are needed");
  }
  std::vector<double> transform;
  for (std::size_t i = 0; i < 9; ++i) {
    transform.push_back(values[i]);
    if (i % 3 == 2) transform.push_back(0.0);
  }
  return rigidTransform(path, line, transform);
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
  std::optional<Eigen::Isometry3d> Tr, Tr_unrectified;
  Eigen::Isometry3d rectification = Eigen::Isometry3d::Identity();
  for (const TextLine& line : readTextLines(path)) {
    const auto [key, rest] = splitAtKey(line.text);
    const auto numbers = [&, text = rest] { return parseNumbers(path, line.number, text); };
    if (key == "Tr") {
      Tr = rigidTransform(path, line.number, numbers());
    } else if (key == "Tr_velo_to_cam" || key == "Tr_velo_cam") {
      Tr_unrectified = rigidTransform(path, line.number, numbers());
    } else if (key == "R0_rect" || key == "R_rect") {
      rectification = rotation(path, line.number, numbers());
    }
  }
  if (Tr) return *Tr;
  if (Tr_unrectified) return rectification * *Tr_unrectified;
  throw Error(path.string(), "", "no line Tr (LiDAR to left camera)");
}

}  // namespace saw_ndt
