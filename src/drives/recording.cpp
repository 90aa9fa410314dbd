#include "saw_ndt/drives/recording.h"

#include <stdexcept>

#include "common/middle_value.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/io/trajectory.h"

namespace saw_ndt {

namespace {

class SelectedScans : public ScanSource {
 public:
  SelectedScans(const Recording& recording, const std::vector<int>& numbers)
      : recording_(recording), numbers_(numbers), has_stamps_(recording.hasStamps()) {
    if (has_stamps_) recording.stamps();
    if (recording.hasPoses() && !numbers.empty()) recording.referencePose(numbers.front());
  }

  bool next(RecordedScan& scan) override {
    if (next_ == numbers_.size()) return false;
    const int number = numbers_[next_++];
    scan.number = number;
    scan.name = recording_.scanName(number);
    scan.stamp_s = has_stamps_ ? recording_.stamps()[static_cast<std::size_t>(number)] : 0.0;
    scan.T_map_lidar.reset();
    if (recording_.hasPoses()) scan.T_map_lidar = recording_.referencePose(number);
    scan.failure.clear();
    try {
      recording_.readScan(number, scan);
    } catch (const Error& error) {
      static_cast<ScanPoints&>(scan) = ScanPoints();
      scan.failure = error.what();
    }
    return true;
  }

  std::optional<std::size_t> scanCount() const override { return numbers_.size(); }

 private:
  const Recording& recording_;
  std::vector<int> numbers_;
  std::size_t next_ = 0;
  bool has_stamps_;
};

}  // namespace

std::size_t Recording::requireScan(int scan) const {
  if (scan < 0 || scan >= scanCount()) {
    throw std::out_of_range("scan " + std::to_string(scan) + ": " + path_.string() + " has scans 0 to " +
                            std::to_string(scanCount() - 1));
  }
  return static_cast<std::size_t>(scan);
}

double Recording::scanPeriod() const {
  std::vector<double> periods_s;
  const std::vector<double>& stamps_s = stamps();
  for (std::size_t i = 1; i < stamps_s.size(); ++i) {
    if (stamps_s[i] > stamps_s[i - 1]) periods_s.push_back(stamps_s[i] - stamps_s[i - 1]);
  }
  if (periods_s.empty()) return kNominalScanPeriod_s;
  return internal::middleValue(periods_s);
}

std::vector<StampedPose> Recording::trajectory() const {
  std::vector<StampedPose> result;
  for (int scan = 0; scan < scanCount(); ++scan) {
    const double stamp_s = stamps()[static_cast<std::size_t>(scan)];
    if (!result.empty() && stamp_s <= result.back().stamp_s) continue;
    if (const std::optional<Eigen::Isometry3d> pose = referencePose(scan)) result.push_back({stamp_s, *pose});
  }
  return result;
}

std::unique_ptr<ScanSource> Recording::scans(const std::vector<int>& numbers) const {
  return std::make_unique<SelectedScans>(*this, numbers);
}

}  // namespace saw_ndt
