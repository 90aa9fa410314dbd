#include "recording_argument.h"

namespace saw_ndt {

void RecordingArgument::addTo(AppOptions& app, bool with_poses) {
  if (with_poses) {
    app.addOption("poses", &poses_file_, "FILE",
                  "reference poses instead of the recording's own: TUM or CSV, of the LiDAR, or KITTI, a line a scan, "
                  "of the left camera where there is its calibration (default: those of the bag, KITTI's oxts, or "
                  "poses.txt in or above the folder, or ../../poses/<name>.txt)");
  }
  app.addOption("topic", &values_.topic, "NAME",
                "point clouds of a bag (default: the only topic of such), or address of the sensor in a capture "
                "(default: that with "
                "the most packets)");
  app.addOption("pose-topic", &values_.pose_topic, "NAME",
                "reference poses of a bag (PoseStamped, PoseWithCovarianceStamped or Odometry), or `tf`, or `none` "
                "(default: the only topic of such, else tf)");
  app.addOption("fixed-frame", &values_.fixed_frame, "FRAME", "of tf, in which poses are (default: its root)");
  app.addOption("scan-rate", &values_.scan_rate_hz, "HZ", "of scans without stamps; 0: they must have some");
  app.addOption("velodyne-calibration", &velodyne_calibration_, "FILE.xml",
                "of a Velodyne HDL-64E whose capture is read");
  bin_fields_.addTo(app);
}

std::unique_ptr<Recording> RecordingArgument::open(const std::string& path, const std::string& poses_file) const {
  RecordingOptions options = values_;
  options.bin_fields = bin_fields_.value();
  options.poses_file = poses_file;
  options.velodyne_calibration = velodyne_calibration_;
  return checkedUsage([&] { return openRecording(path, options); });
}

}  // namespace saw_ndt
