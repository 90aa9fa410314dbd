#include "drives/kitti_raw_drive.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "drives/numbered_files.h"
#include "io/bin_scan.h"
#include "io/kitti_calibration.h"
#include "io/kitti_oxts.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/io/kitti.h"
#include "saw_ndt/io/scan_file.h"
#include "saw_ndt/io/trajectory.h"

namespace saw_ndt::internal {

namespace fs = std::filesystem;

namespace {

/// Where the files lie that describe a drive.
struct KittiFiles {
  fs::path scans;        ///< folder of .bin files
  fs::path stamps;       ///< a line a number from 0; empty: kNominalScanPeriod_s apart
  fs::path oxts;         ///< a file of a line a number, or a folder of a file a number
  fs::path calibration;  ///< a file with Tr_velo_cam and the like, or a folder with calib_velo_to_cam.txt and others
};

class KittiOxtsDrive : public Recording {
 public:
  KittiOxtsDrive(const fs::path& folder, KittiFiles files, int bin_fields)
      : Recording(folder, fs::weakly_canonical(folder).filename().string()),
        files_(std::move(files)),
        scans_(numberedFiles(files_.scans, ".bin")),
        bin_fields_(bin_fields) {
    requireBinFields(bin_fields);
    if (scans_.empty()) throw Error(files_.scans.string(), "", "holds no numbered .bin file");
  }

  int scanCount() const override { return static_cast<int>(scans_.size()); }
  std::string scanName(int scan) const override { return scans_[requireScan(scan)].path.filename().string(); }
  void readScan(int scan, ScanPoints& points) const override {
    if (bin_fields_ == 0) {
      std::vector<fs::path> paths;
      for (const NumberedFile& file : scans_) paths.push_back(file.path);
      bin_fields_ = binFieldsOfScans(paths);
    }
    readScanPoints(scans_[requireScan(scan)].path, points, bin_fields_);
  }

  bool hasStamps() const override { return files_.stamps.empty() || fs::exists(files_.stamps); }
  const std::vector<double>& stamps() const override {
    if (!stamps_s_.empty()) return stamps_s_;
    const std::vector<double> all_s = files_.stamps.empty() ? std::vector<double>() : readStamps(files_.stamps);
    for (const NumberedFile& scan : scans_) {
      if (files_.stamps.empty()) {
        stamps_s_.push_back(static_cast<double>(scan.number) * kNominalScanPeriod_s);
        continue;
      }
      if (scan.number >= all_s.size()) {
        stamps_s_.clear();
        throw Error(files_.stamps.string(), "",
                    std::to_string(all_s.size()) + " times, where " + scan.path.string() + " needs line " +
                        std::to_string(linesUpTo(scan.number)));
      }
      stamps_s_.push_back(all_s[scan.number]);
    }
    return stamps_s_;
  }
  std::string stampsPlace() const override { return (files_.stamps.empty() ? path() : files_.stamps).string(); }

  bool hasPoses() const override { return fs::exists(files_.oxts); }
  std::optional<Eigen::Isometry3d> referencePose(int scan) const override {
    const std::size_t place = requireScan(scan);
    if (hasPoses() && T_map_lidar_.empty()) readPoses();
    return hasPoses() ? T_map_lidar_[place] : std::nullopt;
  }

  std::optional<Eigen::Isometry3d> cameraCalibration() const override {
    if (fs::is_regular_file(files_.calibration)) return readKittiCalibration(files_.calibration);
    const fs::path file = files_.calibration / "calib_velo_to_cam.txt";
    if (!fs::exists(file)) return std::nullopt;
    const fs::path cameras = files_.calibration / "calib_cam_to_cam.txt";
    const Eigen::Isometry3d T_camera_lidar = readKittiRawTransform(file);
    if (!fs::exists(cameras)) return T_camera_lidar;
    const auto rectification = kittiRotation(cameras, {"R_rect_00"});
    return rectification.value_or(Eigen::Isometry3d::Identity()) * T_camera_lidar;
  }

 private:
  /// T_lidar_imu.
  Eigen::Isometry3d imuCalibration() const {
    if (!fs::is_regular_file(files_.calibration)) {
      return readKittiRawTransform(files_.calibration / "calib_imu_to_velo.txt");
    }
    const auto T_lidar_imu = kittiTransform(files_.calibration, {"Tr_imu_to_velo", "Tr_imu_velo"});
    if (!T_lidar_imu) throw Error(files_.calibration.string(), "", "no line Tr_imu_velo (IMU to LiDAR)");
    return *T_lidar_imu;
  }

  void readPoses() const {
    std::vector<OxtsRecord> records;
    std::vector<std::size_t> scans;  // whose the records are
    if (fs::is_regular_file(files_.oxts)) {
      const std::vector<OxtsRecord> lines = readOxts(files_.oxts);
      for (std::size_t i = 0; i < scans_.size(); ++i) {
        if (scans_[i].number >= lines.size()) continue;
        records.push_back(lines[scans_[i].number]);
        scans.push_back(i);
      }
    } else {
      const std::vector<NumberedFile> files = numberedFiles(files_.oxts, ".txt");
      for (std::size_t i = 0; i < scans_.size(); ++i) {
        const auto file = std::lower_bound(files.begin(), files.end(), scans_[i].number,
                                           [](const NumberedFile& a, unsigned long long b) { return a.number < b; });
        if (file == files.end() || file->number != scans_[i].number) continue;
        const std::vector<OxtsRecord> lines = readOxts(file->path);
        if (lines.size() != 1) throw Error(file->path.string(), "", "one line is needed");
        records.push_back(lines.front());
        scans.push_back(i);
      }
    }
    const Eigen::Isometry3d T_lidar_imu = imuCalibration();
    const std::vector<Eigen::Isometry3d> T_first_imu = imuPoses(records);
    T_map_lidar_.resize(scans_.size());
    for (std::size_t i = 0; i < scans.size(); ++i) {
      T_map_lidar_[scans[i]] = normalizedRotation(T_lidar_imu * T_first_imu[i] * T_lidar_imu.inverse());
    }
  }

  KittiFiles files_;
  std::vector<NumberedFile> scans_;
  mutable int bin_fields_;                // 0: not told yet
  mutable std::vector<double> stamps_s_;  // empty: not read yet
  mutable std::vector<std::optional<Eigen::Isometry3d>> T_map_lidar_;
};

/// The folder of training or testing data that a sequence of the tracking benchmark lies in.
fs::path trackingFolder(const fs::path& sequence) { return fs::weakly_canonical(sequence).parent_path().parent_path(); }

fs::path trackingFile(const fs::path& sequence, const char* kind) {
  return trackingFolder(sequence) / kind / (fs::weakly_canonical(sequence).filename().string() + ".txt");
}

}  // namespace

bool isKittiRawDrive(const fs::path& folder) { return fs::is_directory(folder / "velodyne_points" / "data"); }

std::unique_ptr<Recording> openKittiRawDrive(const fs::path& folder, const RecordingOptions& options) {
  const fs::path above = fs::weakly_canonical(folder).parent_path();
  KittiFiles files;
  files.scans = folder / "velodyne_points" / "data";
  files.stamps = folder / "velodyne_points" / "timestamps.txt";
  files.oxts = folder / "oxts" / "data";
  files.calibration = fs::exists(above / "calib_velo_to_cam.txt") ? above : folder;
  return std::make_unique<KittiOxtsDrive>(folder, files, options.bin_fields);
}

bool isKittiTrackingSequence(const fs::path& folder) {
  return fs::weakly_canonical(folder).parent_path().filename() == "velodyne" &&
         fs::exists(trackingFile(folder, "calib"));
}

std::unique_ptr<Recording> openKittiTrackingSequence(const fs::path& folder, const RecordingOptions& options) {
  KittiFiles files;
  files.scans = folder;
  files.oxts = trackingFile(folder, "oxts");
  files.calibration = trackingFile(folder, "calib");
  return std::make_unique<KittiOxtsDrive>(folder, files, options.bin_fields);
}

}  // namespace saw_ndt::internal
