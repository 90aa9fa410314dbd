#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/drives/recording.h"

namespace saw_ndt {

/// A recorded drive in KITTI odometry layout: `velodyne/*.bin`, and where they exist `calib.txt`, `times.txt`,
/// `labels/*.label` and poses.
///
/// Scans are numbered 0 .. scanCount() - 1 in the order of the numbers that are their file names. A times or poses file
/// with one line a scan belongs to the scans in that order; one with more lines is taken to cover the whole drive, and
/// a scan has the line of its file's number, from 0. Only the list of scans is read at once; each other file is read
/// when asked for, so that a drive without calibration or poses can still be used for what does not need them. Not to
/// be shared by threads.
class SAW_NDT_EXPORT KittiSequence : public Recording {
 public:
  /// @param folder      the sequence
  /// @param poses_file  its poses; empty: `folder/poses.txt`, then `folder/../../poses/<name>.txt`, of the path as
  ///                    given or, behind symbolic links, as it is
  /// @param bin_fields  floats a point of its scans: 4, 5 or 6; 0: told from the first scan whose values say
  /// Throws Error where the folder has no numbered scan, or where `poses_file` is named and missing, and
  /// std::invalid_argument for other bin_fields.
  explicit KittiSequence(const std::filesystem::path& folder, const std::filesystem::path& poses_file = {},
                         int bin_fields = 0);

  const std::filesystem::path& folder() const { return path(); }
  int scanCount() const override { return static_cast<int>(scans_.size()); }
  std::string scanName(int scan) const override;

  /// The file of a scan. Here and below std::out_of_range is thrown unless 0 <= scan < scanCount().
  std::filesystem::path scanPath(int scan) const;
  /// The SemanticKITTI file of a scan, whether it exists or not.
  std::filesystem::path labelPath(int scan) const;

  /// Reads the points of a scan; see readScanPoints().
  std::vector<LidarPoint> readScan(int scan) const;
  void readScan(int scan, ScanPoints& points) const override;
  /// Reads the class of each point of a scan; an Error where their number differs from the scan's points.
  std::vector<std::uint16_t> readLabels(int scan) const;

  /// Whether there is times.txt.
  bool hasStamps() const override;
  /// The stamp (s) of every scan; times.txt is read by the first call. Throws Error where it is missing or has too few
  /// lines.
  const std::vector<double>& stamps() const override;
  std::string stampsPlace() const override;
  /// Reads `Tr` of calib.txt; see readKittiCalibration().
  Eigen::Isometry3d T_camera_lidar() const;
  std::optional<Eigen::Isometry3d> cameraCalibration() const override { return T_camera_lidar(); }

  /// Whether there is a poses file.
  bool hasPoses() const override { return !poses_file_.empty(); }
  /// The poses file; empty where there is none.
  const std::filesystem::path& posesFile() const { return poses_file_; }
  /// The LiDAR pose of every scan, read by the first call: T_map_lidar = Tr^-1 P Tr with P the camera's pose; the map
  /// is the LiDAR frame of the drive's first scan. Throws Error where poses or calibration are missing, too few, or no
  /// rigid transforms.
  const std::vector<Eigen::Isometry3d>& posesLidar() const;

  /// One of posesLidar().
  std::optional<Eigen::Isometry3d> referencePose(int scan) const override;

 private:
  struct Scan {
    unsigned long long number;
    std::string stem;
  };

  const Scan& scanAt(int scan) const;
  int binFields() const;
  std::vector<std::size_t> linesOfScans(const std::filesystem::path& path, const std::string& what,
                                        std::size_t line_count) const;

  std::filesystem::path poses_file_;
  std::vector<Scan> scans_;
  mutable int bin_fields_;                              // 0: not told yet
  mutable std::vector<double> stamps_s_;                // empty: not read yet
  mutable std::vector<Eigen::Isometry3d> T_map_lidar_;  // empty: not read yet
};

}  // namespace saw_ndt
