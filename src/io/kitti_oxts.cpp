#include "io/kitti_oxts.h"

#include <cmath>
#include <optional>

#include "io/kitti_calibration.h"
#include "io/number_lines.h"
#include "io/rigid_transform.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt::internal {

namespace {

constexpr std::size_t kOxtsColumns = 30;
constexpr double kEarthRadius_m = 6378137.0;

}  // namespace

std::vector<OxtsRecord> readOxts(const std::filesystem::path& path) {
  std::vector<OxtsRecord> records;
  for (const NumberLine& line : readNumberLines(path)) {
    const std::vector<double>& v = line.values;
    if (v.size() != kOxtsColumns) {
      throw Error(path.string(), linePlace(line.number),
                  std::to_string(v.size()) + " numbers, where " + std::to_string(kOxtsColumns) + " are needed");
    }
    if (std::abs(v[0]) >= 90.0)
      throw Error(path.string(), linePlace(line.number), "the latitude is 90 degrees or more");
    records.push_back({v[0], v[1], v[2], v[3], v[4], v[5]});
  }
  return records;
}

std::vector<Eigen::Isometry3d> imuPoses(const std::vector<OxtsRecord>& records) {
  std::vector<Eigen::Isometry3d> poses;
  std::optional<Eigen::Isometry3d> T_first_mercator;
  for (const OxtsRecord& record : records) {
    const double scale_m = kEarthRadius_m * std::cos(radiansFromDegrees(records.front().latitude_deg));
    Vector6d xyz_rpy;
    xyz_rpy << scale_m * radiansFromDegrees(record.longitude_deg),
        scale_m * std::log(std::tan(0.5 * radiansFromDegrees(90.0 + record.latitude_deg))), record.altitude_m,
        record.roll, record.pitch, record.yaw;
    const Eigen::Isometry3d T_mercator_imu = transformFromXyzRpy(xyz_rpy);
    if (!T_first_mercator) T_first_mercator = T_mercator_imu.inverse();
    poses.push_back(normalizedRotation(*T_first_mercator * T_mercator_imu));
  }
  return poses;
}

Eigen::Isometry3d readKittiRawTransform(const std::filesystem::path& path) {
  const NumberLine R = kittiNumbers(path, {"R"}), T = kittiNumbers(path, {"T"});
  if (R.values.size() != 9 || T.values.size() != 3) {
    throw Error(path.string(), "", "a line R of 9 numbers and a line T of 3 are needed");
  }
  std::vector<double> rows;
  for (std::size_t i = 0; i < 3; ++i) {
    rows.insert(rows.end(), R.values.begin() + static_cast<std::ptrdiff_t>(3 * i),
                R.values.begin() + static_cast<std::ptrdiff_t>(3 * i + 3));
    rows.push_back(T.values[i]);
  }
  return rigidTransform(path, R.number, rows);
}

}  // namespace saw_ndt::internal
