#include "saw_ndt/io/kitti.h"

#include <algorithm>
#include <array>
#include <iomanip>

#include "common/atomic_output.h"
#include "common/input_file.h"
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

/// Reads the records of a binary file without a header, into memory that `values` may bring along; Error unless there
/// is at least one and the last one is whole.
template <typename Value>
void readRecords(const fs::path& path, std::vector<Value>& values) {
  std::ifstream stream = openInputFile(path);
  stream.seekg(0, std::ios::end);
  const std::streamoff end = stream.tellg();
  if (end < 0) throw Error(path.string(), "", "its size cannot be told");
  const auto size = static_cast<std::size_t>(end);
  if (size == 0) throw Error(path.string(), "offset 0", "the file is empty");
  if (size % sizeof(Value) != 0) {
    throw Error(path.string(), "offset " + std::to_string(size - size % sizeof(Value)),
                "the last point is cut short: " + std::to_string(size) + " bytes is no multiple of " +
                    std::to_string(sizeof(Value)));
  }
  values.resize(size / sizeof(Value));
  stream.seekg(0);
  stream.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(size));
  if (!stream) throw Error(path.string(), "offset " + std::to_string(stream.gcount()), "could not be read on");
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

std::vector<LidarPoint> readKittiScan(const fs::path& path) {
  std::vector<LidarPoint> points;
  readKittiScan(path, points);
  return points;
}

void readKittiScan(const fs::path& path, std::vector<LidarPoint>& points) {
  static_assert(sizeof(LidarPoint) == 4 * sizeof(float));
  readRecords(path, points);
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
  for (const TextLine& line : readTextLines(path)) {
    const std::size_t colon = line.text.find(':');
    const std::string key = line.text.substr(0, colon);
    if (key != "Tr" && key != "Tr_velo_to_cam" && key != "Tr_velo_cam") continue;
    if (colon == std::string::npos) throw Error(path.string(), linePlace(line.number), "no ':' after " + key);
    return rigidTransform(path, line.number, parseNumbers(path, line.number, line.text.substr(colon + 1)));
  }
  throw Error(path.string(), "", "no line Tr (LiDAR to left camera)");
}

}  // namespace saw_ndt
