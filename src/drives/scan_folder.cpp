#include "drives/scan_folder.h"

#include <algorithm>
#include <set>
#include <vector>

#include "io/bin_scan.h"
#include "io/natural_order.h"
#include "io/pcd_fields.h"
#include "io/ply_cloud.h"
#include "io/stamp_text.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/io/kitti.h"
#include "saw_ndt/io/scan_file.h"
#include "saw_ndt/io/trajectory.h"

namespace saw_ndt::internal {

namespace fs = std::filesystem;

namespace {

/// The first of these files that exists in a folder or in the one above it; empty where none does.
fs::path findBeside(const fs::path& folder, const std::vector<std::string>& names) {
  const fs::path as_is = fs::weakly_canonical(folder);
  for (const fs::path& place : {as_is, as_is.parent_path()}) {
    for (const std::string& name : names) {
      if (fs::is_regular_file(place / name)) return place / name;
    }
  }
  return {};
}

fs::path folderOf(const fs::path& path) { return fs::is_directory(path) ? path : fs::absolute(path).parent_path(); }

std::vector<fs::path> scansIn(const fs::path& path) {
  if (!fs::is_directory(path)) return {path};
  std::vector<fs::path> files;
  std::set<std::string> kinds;
  for (const fs::directory_entry& entry : fs::directory_iterator(path)) {
    if (!entry.is_regular_file() || !isScanFile(entry.path())) continue;
    files.push_back(entry.path());
    kinds.insert(entry.path().extension().string());
  }
  if (files.empty()) throw Error(path.string(), "", "holds no .pcd, .ply or .bin file");
  if (kinds.size() > 1) {
    throw Error(path.string(), "",
                "holds scans of several kinds, " + *kinds.begin() + " and " + *kinds.rbegin() +
                    ": which of them are meant cannot be told");
  }
  return files;
}

class ScanFolder : public Recording {
 public:
  ScanFolder(const fs::path& path, const RecordingOptions& options)
      : Recording(path, fs::weakly_canonical(path).filename().string()), bin_fields_(options.bin_fields) {
    requireBinFields(bin_fields_);
    scans_ = scansIn(path);
    names_are_stamps_ = sortScans(scans_);
    stamps_file_ = findBeside(folderOf(path), {"times.txt", "timestamps.txt", "stamps.txt"});
    calibration_file_ = findBeside(folderOf(path), {"calib.txt"});
  }

  int scanCount() const override { return static_cast<int>(scans_.size()); }
  std::string scanName(int scan) const override { return scans_[requireScan(scan)].filename().string(); }
  void readScan(int scan, ScanPoints& points) const override {
    const fs::path& file = scans_[requireScan(scan)];
    readScanPoints(file, points, isBinScan(file) ? binFields() : 0);
  }

  bool hasStamps() const override { return !stamps_file_.empty() || names_are_stamps_; }
  const std::vector<double>& stamps() const override {
    if (!stamps_s_.empty()) return stamps_s_;
    if (!hasStamps()) {
      throw Error(
          path().string(), "",
          "has no stamps: neither times.txt, timestamps.txt or stamps.txt nor the names of the scans give them");
    }
    if (stamps_file_.empty()) {
      for (const fs::path& file : scans_) stamps_s_.push_back(*stampOfName(file.stem().string()));
      return stamps_s_;
    }
    std::vector<double> stamps_s = readStamps(stamps_file_);
    if (stamps_s.size() != scans_.size()) {
      throw Error(stamps_file_.string(), "",
                  std::to_string(stamps_s.size()) + " times, where " + path().string() + " has " +
                      std::to_string(scans_.size()) + " scans");
    }
    stamps_s_ = std::move(stamps_s);
    return stamps_s_;
  }
  std::string stampsPlace() const override {
    return stamps_file_.empty() ? path().string() + ": names of the scans" : stamps_file_.string();
  }

  bool hasPoses() const override { return false; }
  std::optional<Eigen::Isometry3d> referencePose(int scan) const override {
    requireScan(scan);
    return std::nullopt;
  }
  std::optional<Eigen::Isometry3d> cameraCalibration() const override {
    if (calibration_file_.empty()) return std::nullopt;
    return readKittiCalibration(calibration_file_);
  }

 private:
  int binFields() const {
    if (bin_fields_ == 0) bin_fields_ = binFieldsOfScans(scans_);
    return bin_fields_;
  }

  std::vector<fs::path> scans_;
  bool names_are_stamps_ = false;
  fs::path stamps_file_, calibration_file_;  // empty: there are none
  mutable int bin_fields_;                   // 0: not told yet
  mutable std::vector<double> stamps_s_;     // empty: not read yet
};

}  // namespace

bool sortScans(std::vector<fs::path>& files) {
  struct Named {
    fs::path file;
    std::optional<double> stamp_s;
  };
  std::vector<Named> named;
  for (const fs::path& file : files) named.push_back({file, stampOfName(file.stem().string())});
  const bool are_stamps =
      std::all_of(named.begin(), named.end(), [](const Named& scan) { return scan.stamp_s.has_value(); });
  std::sort(named.begin(), named.end(), [&](const Named& a, const Named& b) {
    if (are_stamps && *a.stamp_s != *b.stamp_s) return *a.stamp_s < *b.stamp_s;
    return naturallyBefore(a.file.filename().string(), b.file.filename().string());
  });
  for (std::size_t i = 0; i < files.size(); ++i) files[i] = named[i].file;
  return are_stamps;
}

bool isScanFile(const fs::path& path) { return path.extension() == ".pcd" || isPly(path) || isBinScan(path); }

bool holdsScans(const fs::path& folder) {
  const fs::directory_iterator entries(folder);
  return std::any_of(begin(entries), end(entries), [](const fs::directory_entry& entry) {
    return entry.is_regular_file() && isScanFile(entry.path());
  });
}

std::unique_ptr<Recording> openScanFolder(const fs::path& folder, const RecordingOptions& options) {
  return std::make_unique<ScanFolder>(folder, options);
}

fs::path posesOfScanFolder(const fs::path& folder) {
  return findBeside(folderOf(folder), {"poses.txt", "poses.tum", "poses.csv"});
}

}  // namespace saw_ndt::internal
