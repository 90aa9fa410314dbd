#include "saw_ndt/io/trajectory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <optional>
#include <string>
#include <string_view>

#include "common/atomic_output.h"
#include "io/csv_table.h"
#include "io/csv_trajectory.h"
#include "io/number_lines.h"
#include "io/rigid_transform.h"
#include "io/stamp_text.h"
#include "io/tum_pose.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt {

using namespace internal;

namespace {

constexpr std::size_t kTumColumns = 8;
constexpr std::size_t kKittiColumns = 12;
constexpr double kRigidityTolerance = 1e-3;

void requireColumns(const std::filesystem::path& path, const NumberLine& line, std::size_t columns) {
  if (line.values.size() == columns) return;
  throw Error(path.string(), linePlace(line.number),
              std::to_string(line.values.size()) + " numbers, where " + std::to_string(columns) + " are needed");
}

std::vector<NumberLine> poseLines(const std::filesystem::path& path, const std::vector<TextLine>& texts) {
  std::vector<NumberLine> lines = parseNumberLines(path, texts);
  if (lines.empty()) throw Error(path.string(), "", "holds no pose");
  return lines;
}

std::vector<NumberLine> readPoseLines(const std::filesystem::path& path) { return poseLines(path, readAllLines(path)); }

StampedPose tumPose(const std::filesystem::path& path, const NumberLine& line) {
  requireColumns(path, line, kTumColumns);
  std::array<double, kTumColumns> values{};
  std::copy(line.values.begin(), line.values.end(), values.begin());
  return stampedPose(path, line.number, values);
}

std::vector<StampedPose> tumPoses(const std::filesystem::path& path, const std::vector<NumberLine>& lines) {
  std::vector<StampedPose> poses;
  for (const NumberLine& line : lines) poses.push_back(tumPose(path, line));
  return poses;
}

std::vector<Eigen::Isometry3d> kittiPoses(const std::filesystem::path& path, const std::vector<NumberLine>& lines) {
  std::vector<Eigen::Isometry3d> poses;
  for (const NumberLine& line : lines) poses.push_back(rigidTransform(path, line.number, line.values));
  return poses;
}

}  // namespace

namespace internal {

Eigen::Isometry3d rigidTransform(const std::filesystem::path& path, std::size_t line,
                                 const std::vector<double>& values) {
  requireColumns(path, {line, values}, kKittiColumns);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.affine() = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(values.data());
  const Eigen::Matrix3d R = T.linear();
  const double deviation = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (deviation > kRigidityTolerance || R.determinant() < 0.0) {
    throw Error(path.string(), linePlace(line), "is no rigid transform: its 3x3 part is no rotation");
  }
  return normalizedRotation(T);
}

void writeTumPose(std::ostream& stream, const StampedPose& pose) {
  const Eigen::Vector3d& t = pose.T_map_body.translation();
  Eigen::Quaterniond q = Eigen::Quaterniond(pose.T_map_body.linear()).normalized();
  if (q.w() < 0.0) q.coeffs() *= -1.0;
  stream << std::fixed << std::setprecision(9) << pose.stamp_s << ' ' << t.x() << ' ' << t.y() << ' ' << t.z() << ' '
         << std::setprecision(12) << q.x() << ' ' << q.y() << ' ' << q.z() << ' ' << q.w() << '\n';
}

StampedPose stampedPose(const std::filesystem::path& path, std::size_t line, const std::array<double, 8>& values) {
  const std::array<double, 8>& v = values;
  const Eigen::Quaterniond q(v[7], v[4], v[5], v[6]);
  if (std::abs(q.norm() - 1.0) > kRigidityTolerance) {
    throw Error(path.string(), linePlace(line), "the quaternion's norm is " + std::to_string(q.norm()) + ", not 1");
  }
  StampedPose pose;
  pose.stamp_s = v[0];
  pose.T_map_body.translation() << v[1], v[2], v[3];
  pose.T_map_body.linear() = q.normalized().toRotationMatrix();
  return pose;
}

}  // namespace internal

Trajectory readTrajectory(const std::filesystem::path& path) {
  const std::vector<TextLine> texts = readAllLines(path);
  if (isCsv(texts)) return {TrajectoryFormat::CSV, csvPoses(csvTable(path, texts))};
  const std::vector<NumberLine> lines = poseLines(path, texts);
  const std::size_t columns = lines.front().values.size();
  if (columns == kTumColumns) return {TrajectoryFormat::TUM, tumPoses(path, lines)};
  if (columns != kKittiColumns) {
    throw Error(
        path.string(), linePlace(lines.front().number),
        std::to_string(columns) + " numbers, where 8 (TUM) or 12 (KITTI) are needed, or commas between them (CSV)");
  }
  Trajectory trajectory{TrajectoryFormat::KITTI, {}};
  for (const Eigen::Isometry3d& T : kittiPoses(path, lines)) {
    trajectory.poses.push_back({static_cast<double>(trajectory.poses.size()) * kNominalScanPeriod_s, T});
  }
  return trajectory;
}

std::vector<StampedPose> readTumTrajectory(const std::filesystem::path& path) {
  return tumPoses(path, readPoseLines(path));
}

std::vector<Eigen::Isometry3d> readKittiTrajectory(const std::filesystem::path& path) {
  return kittiPoses(path, readPoseLines(path));
}

std::vector<double> readStamps(const std::filesystem::path& path) {
  std::vector<double> stamps_s;
  for (const TextLine& line : readTextLines(path)) {
    const std::string_view text = std::string_view(line.text).substr(0, line.text.find_last_not_of(" \t\r") + 1);
    if (const std::optional<double> stamp_s = stampOfDate(text)) {
      stamps_s.push_back(*stamp_s);
      continue;
    }
    const NumberLine numbers{line.number, parseNumbers(path, line.number, text)};
    requireColumns(path, numbers, 1);
    stamps_s.push_back(numbers.values.front());
  }
  return stamps_s;
}

void writeStamps(const std::filesystem::path& path, const std::vector<double>& stamps_s) {
  AtomicOutput output(path);
  output.stream() << std::fixed << std::setprecision(9);
  for (const double stamp_s : stamps_s) output.stream() << stamp_s << '\n';
  output.commit();
}

void writeTumTrajectory(const std::filesystem::path& path, const std::vector<StampedPose>& trajectory) {
  AtomicOutput output(path);
  for (const StampedPose& pose : trajectory) writeTumPose(output.stream(), pose);
  output.commit();
}

void writeKittiTrajectory(const std::filesystem::path& path, const std::vector<Eigen::Isometry3d>& poses) {
  AtomicOutput output(path);
  std::ostream& stream = output.stream();
  stream << std::scientific << std::setprecision(12);
  for (const Eigen::Isometry3d& T : poses) {
    for (int i = 0; i < 12; ++i) stream << (i > 0 ? " " : "") << T(i / 4, i % 4);
    stream << '\n';
  }
  output.commit();
}

Eigen::Isometry3d lidarPose(const Eigen::Isometry3d& camera_pose, const Eigen::Isometry3d& T_camera_lidar) {
  return normalizedRotation(T_camera_lidar.inverse() * camera_pose * T_camera_lidar);
}

Eigen::Isometry3d cameraPose(const Eigen::Isometry3d& lidar_pose, const Eigen::Isometry3d& T_camera_lidar) {
  return normalizedRotation(T_camera_lidar * lidar_pose * T_camera_lidar.inverse());
}

}  // namespace saw_ndt
