#pragma once

#include <memory>
#include <string>

#include "app_options.h"
#include "bin_fields_argument.h"
#include "saw_ndt/drives/recording.h"

namespace saw_ndt {

/// The options by which every app that takes a recording is told what it does not say itself.
class RecordingArgument {
 public:
  /// What a SEQUENCE may be, for the help.
  static constexpr char kKinds[] =
      "a recording: a folder in the layout of KITTI odometry, raw or tracking, a folder of .pcd, .ply or .bin files, "
      "a bag of ROS 1 or 2 (.bag, .db3, .mcap or its folder), a capture of a Velodyne (.pcap, .pcapng)";

  /// Declares them, -poses but for apps that take several recordings.
  void addTo(AppOptions& app, bool with_poses = true);

  /// Opens a recording, with the poses of -poses. @throws Error, UsageError
  std::unique_ptr<Recording> open(const std::string& path) const { return open(path, poses_file_); }
  /// The same with the poses of a file, or with its own for an empty name.
  std::unique_ptr<Recording> open(const std::string& path, const std::string& poses_file) const;

  /// -velodyne-calibration, empty where it is not given.
  const std::string& velodyneCalibration() const { return velodyne_calibration_; }
  /// -bin-fields, 0 where it is not given.
  int binFields() const { return bin_fields_.value(); }

 private:
  BinFieldsArgument bin_fields_;
  RecordingOptions values_;
  std::string poses_file_, velodyne_calibration_;
};

}  // namespace saw_ndt
