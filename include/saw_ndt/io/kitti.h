#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace saw_ndt {

/// Reads a Velodyne scan: little-endian float32 x y z reflectance a point, metres, LiDAR frame. `intensity` is the
/// reflectance. Points that are not finite are kept, and `is_dense` says whether there are none. Throws Error where the
/// file is missing, empty, or ends within a point (naming the offset).
pcl::PointCloud<pcl::PointXYZI> readKittiScan(const std::filesystem::path& path);

/// Reads SemanticKITTI labels: the class of each point of a scan, the low 16 bits of a uint32. Throws Error as
/// readKittiScan().
std::vector<std::uint16_t> readSemanticKittiLabels(const std::filesystem::path& path);

/// Writes a Velodyne scan as readKittiScan() reads it, whole or not at all. Throws Error.
void writeKittiScan(const std::filesystem::path& path, const pcl::PointCloud<pcl::PointXYZI>& scan);

/// Writes SemanticKITTI labels, the class of each point of a scan, whole or not at all. Throws Error.
void writeSemanticKittiLabels(const std::filesystem::path& path, const std::vector<std::uint16_t>& classes);

/// Writes a KITTI calib.txt: `Tr`, and `P0` to `P3` of four cameras side by side such as KITTI's. Throws Error.
void writeKittiCalibration(const std::filesystem::path& path, const Eigen::Isometry3d& T_camera_lidar);

/// Reads the transform from the LiDAR to the left camera: the line `Tr` (or `Tr_velo_to_cam`, `Tr_velo_cam`) of a KITTI
/// calib.txt. Throws Error where it is missing or no rigid transform.
Eigen::Isometry3d readKittiCalibration(const std::filesystem::path& path);

/// A recorded drive in KITTI odometry layout: `velodyne/*.bin`, and where they exist `calib.txt`, `times.txt`,
/// `labels/*.label` and poses.
///
/// Scans are numbered 0 .. scanCount() - 1 in the order of the numbers that are their file names. A times or poses file
/// with one line a scan belongs to the scans in that order; one with more lines is taken to cover the whole drive, and
/// a scan has the line of its file's number, from 0. Only the list of scans is read at once; each other file is read
/// when asked for, so that a drive without calibration or poses can still be used for what does not need them.
class KittiSequence {
 public:
  /// @param folder      the sequence
  /// @param poses_file  its poses; empty: `folder/poses.txt`, then `folder/../../poses/<name>.txt`
  /// Throws Error where the folder has no numbered scan, or where `poses_file` is named and missing.
  explicit KittiSequence(const std::filesystem::path& folder, const std::filesystem::path& poses_file = {});

  /// The folder's own name, such as "00".
  const std::string& name() const { return name_; }
  const std::filesystem::path& folder() const { return folder_; }
  int scanCount() const { return static_cast<int>(scans_.size()); }

  /// The file of a scan. Here and below std::out_of_range is thrown unless 0 <= scan < scanCount().
  std::filesystem::path scanPath(int scan) const;
  /// The SemanticKITTI file of a scan, whether it exists or not.
  std::filesystem::path labelPath(int scan) const;

  /// Reads a scan; see readKittiScan().
  pcl::PointCloud<pcl::PointXYZI> readScan(int scan) const;
  /// Reads the class of each point of a scan; an Error where their number differs from the scan's points.
  std::vector<std::uint16_t> readLabels(int scan) const;

  /// Reads the stamp (s) of every scan. Throws Error where times.txt is missing or has too few lines.
  std::vector<double> stamps() const;
  /// Reads `Tr` of calib.txt; see readKittiCalibration().
  Eigen::Isometry3d T_camera_lidar() const;

  /// Whether there is a poses file.
  bool hasPoses() const { return !poses_file_.empty(); }
  /// The poses file; empty where there is none.
  const std::filesystem::path& posesFile() const { return poses_file_; }
  /// Reads the LiDAR pose of every scan, T_map_lidar = Tr^-1 P Tr with P the camera's pose; the map is the LiDAR frame
  /// of the drive's first scan. Throws Error where poses or calibration are missing, too few, or no rigid transforms.
  std::vector<Eigen::Isometry3d> posesLidar() const;

 private:
  struct Scan {
    unsigned long long number;
    std::string stem;
  };

  const Scan& scanAt(int scan) const;
  std::vector<std::size_t> linesOfScans(const std::filesystem::path& path, const std::string& what,
                                        std::size_t line_count) const;

  std::filesystem::path folder_;
  std::filesystem::path poses_file_;
  std::string name_;
  std::vector<Scan> scans_;
};

}  // namespace saw_ndt
