#pragma once

#include <optional>
#include <utility>

#include "localization/synthetic_drive.h"
#include "saw_ndt/drives/scan_source.h"

namespace saw_ndt {

/// The scans of a synthetic drive as a source, without files.
class ScansInMemory : public ScanSource {
 public:
  explicit ScansInMemory(SyntheticDrive drive, bool with_times = false)
      : drive_(std::move(drive)), with_times_(with_times) {}

  bool next(RecordedScan& scan) override {
    if (next_ == drive_.scans.size()) return false;
    scan.number = static_cast<int>(next_);
    scan.name = std::to_string(next_);
    scan.stamp_s = drive_.stamps_s[next_];
    scan.points = drive_.scans[next_];
    scan.times_s.clear();
    if (with_times_) scan.times_s = drive_.times_s[next_];
    scan.T_map_lidar = drive_.T_map_lidar[next_];
    scan.failure.clear();
    ++next_;
    return true;
  }
  std::optional<std::size_t> scanCount() const override { return drive_.scans.size(); }

 private:
  SyntheticDrive drive_;
  bool with_times_;
  std::size_t next_ = 0;
};

}  // namespace saw_ndt
