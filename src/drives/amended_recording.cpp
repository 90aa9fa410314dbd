#include "drives/amended_recording.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "common/pose_interpolation.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/io/trajectory.h"

namespace saw_ndt::internal {

namespace {

/// Passes on what another recording tells.
class AmendedRecording : public Recording {
 public:
  explicit AmendedRecording(std::unique_ptr<Recording> recording)
      : Recording(recording->path(), recording->name()), recording_(std::move(recording)) {}

  int scanCount() const override { return recording_->scanCount(); }
  std::string scanName(int scan) const override { return recording_->scanName(scan); }
  void readScan(int scan, ScanPoints& points) const override { recording_->readScan(scan, points); }
  bool isRaw() const override { return recording_->isRaw(); }
  bool hasStamps() const override { return recording_->hasStamps(); }
  const std::vector<double>& stamps() const override { return recording_->stamps(); }
  std::string stampsPlace() const override { return recording_->stampsPlace(); }
  bool hasPoses() const override { return recording_->hasPoses(); }
  std::optional<Eigen::Isometry3d> referencePose(int scan) const override { return recording_->referencePose(scan); }
  std::optional<Eigen::Isometry3d> cameraCalibration() const override { return recording_->cameraCalibration(); }

 private:
  std::unique_ptr<Recording> recording_;
};

class RecordingWithPoses : public AmendedRecording {
 public:
  RecordingWithPoses(std::unique_ptr<Recording> recording, std::filesystem::path file)
      : AmendedRecording(std::move(recording)), file_(std::move(file)) {
    if (!std::filesystem::exists(file_)) throw Error(file_.string(), "", std::strerror(ENOENT));
  }

  bool hasPoses() const override { return true; }
  std::optional<Eigen::Isometry3d> referencePose(int scan) const override {
    const std::size_t place = requireScan(scan);
    if (T_map_lidar_.empty()) readPoses();
    return T_map_lidar_[place];
  }

 private:
  void readPoses() const {
    Trajectory trajectory = readTrajectory(file_);
    std::vector<StampedPose>& poses = trajectory.poses;
    if (trajectory.format != TrajectoryFormat::KITTI) {
      std::stable_sort(poses.begin(), poses.end(),
                       [](const StampedPose& a, const StampedPose& b) { return a.stamp_s < b.stamp_s; });
      for (const double stamp_s : stamps()) T_map_lidar_.push_back(poseAt(poses, stamp_s, kLongestPoseGap_s));
      return;
    }
    if (poses.size() != static_cast<std::size_t>(scanCount())) {
      throw Error(file_.string(), "",
                  std::to_string(poses.size()) + " poses, where " + path().string() + " has " +
                      std::to_string(scanCount()) + " scans: a file in KITTI format has a line for each");
    }
    const std::optional<Eigen::Isometry3d> T_camera_lidar = cameraCalibration();
    for (const StampedPose& pose : poses) {
      T_map_lidar_.emplace_back(T_camera_lidar ? lidarPose(pose.T_map_body, *T_camera_lidar) : pose.T_map_body);
    }
  }

  std::filesystem::path file_;
  mutable std::vector<std::optional<Eigen::Isometry3d>> T_map_lidar_;  // empty: not read yet
};

class RecordingAtRate : public AmendedRecording {
 public:
  RecordingAtRate(std::unique_ptr<Recording> recording, double scan_rate_hz) : AmendedRecording(std::move(recording)) {
    for (int scan = 0; scan < scanCount(); ++scan) stamps_s_.push_back(static_cast<double>(scan) / scan_rate_hz);
  }

  bool hasStamps() const override { return true; }
  const std::vector<double>& stamps() const override { return stamps_s_; }

 private:
  std::vector<double> stamps_s_;
};

}  // namespace

std::unique_ptr<Recording> withReferencePoses(std::unique_ptr<Recording> recording, const std::filesystem::path& file) {
  return std::make_unique<RecordingWithPoses>(std::move(recording), file);
}

std::unique_ptr<Recording> withScanRate(std::unique_ptr<Recording> recording, double scan_rate_hz) {
  return std::make_unique<RecordingAtRate>(std::move(recording), scan_rate_hz);
}

}  // namespace saw_ndt::internal
