#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/drives/scan_source.h"

namespace saw_ndt {

/// A recorded drive, whatever form its files have: numbered scans, and what is known of each. What describes the scans
/// is read at once or when it is asked for, the scans one at a time. Not to be shared by threads.
class SAW_NDT_EXPORT Recording {
 public:
  virtual ~Recording() = default;

  /// Its own name, such as "00".
  const std::string& name() const { return name_; }
  /// The folder or file that it was opened by.
  const std::filesystem::path& path() const { return path_; }

  virtual int scanCount() const = 0;
  /// The scan's own name, for messages, such as 000012.bin. Here and below std::out_of_range is thrown unless
  /// 0 <= scan < scanCount().
  virtual std::string scanName(int scan) const = 0;
  /// Reads the points of a scan, with their rings and times as readScanPoints() tells them, into memory that `points`
  /// may bring along. Throws Error.
  virtual void readScan(int scan, ScanPoints& points) const = 0;

  /// Whether scans are known to be as the sensor measured them, one point after the other, with the times of points:
  /// the motion of the LiDAR is in them.
  virtual bool isRaw() const { return false; }

  /// Whether it says when scans were taken.
  virtual bool hasStamps() const = 0;
  /// The stamp (s) of every scan. Throws Error where there are none, or too few.
  virtual const std::vector<double>& stamps() const = 0;
  /// What states the stamps, for messages, such as a file.
  virtual std::string stampsPlace() const = 0;

  /// Whether there are reference poses.
  virtual bool hasPoses() const = 0;
  /// T_map_lidar of a scan by reference; nothing where none is known for its stamp. Throws Error where the poses of the
  /// recording are damaged or do not belong to its scans.
  virtual std::optional<Eigen::Isometry3d> referencePose(int scan) const = 0;

  /// T_camera_lidar, whose camera the poses of KITTI trajectories are of; nothing where there is no camera.
  virtual std::optional<Eigen::Isometry3d> cameraCalibration() const { return std::nullopt; }

  /// The reference poses with stamps(), by growing stamps: those whose stamp does not grow are left out.
  std::vector<StampedPose> trajectory() const;
  /// How long a scan takes (s): the median of the times from one stamp to the next; kNominalScanPeriod_s where there
  /// are no two that grow. Throws as stamps().
  double scanPeriod() const;

  /// The given scans one after the other, with stamps and reference poses where there are any. Throws Error as stamps()
  /// and referencePose(). The recording must live as long as the source.
  std::unique_ptr<ScanSource> scans(const std::vector<int>& numbers) const;

 protected:
  Recording(std::filesystem::path path, std::string name) : path_(std::move(path)), name_(std::move(name)) {}
  Recording(const Recording&) = default;
  Recording(Recording&&) = default;
  Recording& operator=(const Recording&) = default;
  Recording& operator=(Recording&&) = default;

  /// Throws std::out_of_range unless there is such a scan.
  std::size_t requireScan(int scan) const;

 private:
  std::filesystem::path path_;
  std::string name_;
};

/// What is not told by a recording itself.
struct RecordingOptions {
  /// Reference poses instead of the recording's own: TUM or CSV (of the LiDAR, in the map) or KITTI, a line a scan (of
  /// the left camera where the recording has its calibration, else of the LiDAR).
  std::filesystem::path poses_file;
  int bin_fields = 0;         ///< floats a point of .bin files: 4, 5 or 6; 0: told from the values
  double scan_rate_hz = 0.0;  ///< gives scans stamps where the recording has none; 0: they have none then
  /// Of the point clouds of a bag, empty: the only one; the address of the sensor in a capture, empty: the one with the
  /// most packets.
  std::string topic;
  /// Of the poses of a bag, or `tf`, or `none`; empty: the only one of poses, else tf where it has the LiDAR's frame.
  std::string pose_topic;
  std::string fixed_frame;  ///< of tf, in which poses are; empty: the root of the LiDAR's frame
  /// Calibration of a Velodyne HDL-64E (db.xml), without which its captures cannot be read.
  std::filesystem::path velodyne_calibration;
};

/// Opens a recording of any kind, told apart by what is there: a folder in the layout of KITTI odometry (`velodyne/`)
/// or of KITTI raw data (`velodyne_points/`); a folder of .pcd, .ply or .bin files; a bag of ROS 1 (.bag) or ROS 2
/// (.db3, .mcap, or the folder of one); a capture of a Velodyne (.pcap, .pcapng). Files are told by their first bytes.
/// Throws Error where there is no such recording, or where this library was built without what reads it, and
/// std::invalid_argument for options that do not hold.
SAW_NDT_EXPORT std::unique_ptr<Recording> openRecording(const std::filesystem::path& path,
                                                        const RecordingOptions& options = {});

}  // namespace saw_ndt
