#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "drives/amended_recording.h"
#include "drives/bag_recording.h"
#include "drives/kitti_raw_drive.h"
#include "drives/scan_folder.h"
#if SAW_NDT_HAS_PCAP
#include "drives/velodyne_capture.h"
#endif
#include "io/capture_magic.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/drives/recording.h"
#include "saw_ndt/io/trajectory.h"

namespace saw_ndt {

using namespace internal;

namespace fs = std::filesystem;

namespace {

/// Whether a folder is in the layout of KITTI odometry: its scans in `velodyne` are .bin files.
bool isKittiOdometry(const fs::path& path) {
  const fs::path velodyne = path / "velodyne";
  if (!fs::is_directory(velodyne)) return false;
  const fs::directory_iterator entries(velodyne);
  return std::none_of(begin(entries), end(entries), [](const fs::directory_entry& entry) {
    return entry.path().extension() == ".pcd" || entry.path().extension() == ".ply";
  });
}

std::unique_ptr<Recording> openKittiOdometry(const fs::path& path, const RecordingOptions& options) {
  const fs::path& poses = options.poses_file;
  const bool has_line_a_scan =
      !poses.empty() && fs::exists(poses) && readTrajectory(poses).format == TrajectoryFormat::KITTI;
  auto sequence = std::make_unique<KittiSequence>(path, has_line_a_scan ? poses : fs::path(), options.bin_fields);
  if (poses.empty() || has_line_a_scan) return sequence;
  return withReferencePoses(std::move(sequence), poses);
}

std::unique_ptr<Recording> openCapture(const fs::path& path, [[maybe_unused]] const RecordingOptions& options) {
#if SAW_NDT_HAS_PCAP
  return openVelodyneCapture(path, options);
#else
  throw Error(path.string(), "", "cannot be read, since saw_ndt was built without libpcap-dev");
#endif
}

/// A recording with the reference poses that lie beside it.
std::unique_ptr<Recording> openWithOwnPoses(const fs::path& path, const RecordingOptions& options) {
  if (isKittiRawDrive(path)) return openKittiRawDrive(path, options);
  if (fs::is_regular_file(path) && isCapture(path)) return openCapture(path, options);
  if (isBag(path)) return openBag(path, options);
  if (isKittiTrackingSequence(path)) return openKittiTrackingSequence(path, options);
  const fs::path scans = fs::is_directory(path / "velodyne") ? path / "velodyne" : path;
  if (!fs::is_directory(scans) && !isScanFile(scans)) {
    throw Error(path.string(), "",
                "is no recording that is known: no bag of ROS, no capture of a Velodyne, no .pcd, .ply or .bin file");
  }
  if (fs::is_directory(scans) && !holdsScans(scans)) {
    throw Error(path.string(), "",
                "holds no recording: no `velodyne` or `velodyne_points` as KITTI's, no .pcd, .ply or .bin files, no "
                "bag of ROS 2");
  }
  std::unique_ptr<Recording> recording = openScanFolder(scans, options);
  const fs::path poses = posesOfScanFolder(scans);
  return poses.empty() ? std::move(recording) : withReferencePoses(std::move(recording), poses);
}

}  // namespace

std::unique_ptr<Recording> openRecording(const fs::path& path, const RecordingOptions& options) try {
  checkOption(options.scan_rate_hz >= 0.0 && std::isfinite(options.scan_rate_hz), "scan_rate_hz", options.scan_rate_hz,
              "0 or more");
  if (!fs::exists(path)) throw Error(path.string(), "", std::strerror(ENOENT));
  const bool is_kitti = isKittiOdometry(path);
  std::unique_ptr<Recording> recording = is_kitti ? openKittiOdometry(path, options) : openWithOwnPoses(path, options);
  if (options.scan_rate_hz > 0.0 && !recording->hasStamps()) {
    recording = withScanRate(std::move(recording), options.scan_rate_hz);
  }
  if (!is_kitti && !options.poses_file.empty()) {
    recording = withReferencePoses(std::move(recording), options.poses_file);
  }
  return recording;
} catch (const fs::filesystem_error& failure) {
  // Such as of a folder that may not be searched.
  throw Error(failure.path1().string(), "", failure.code().message());
}

}  // namespace saw_ndt
