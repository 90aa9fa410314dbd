#include "saw_ndt/drives/drive_localization.h"

namespace saw_ndt {

DriveLocalization localizeDrive(Localizer& localizer, ScanSource& scans, const std::function<void()>& scan_done) {
  const auto localize = [&](const ScanView& scan, double stamp_s, const ScanPriors& priors) {
    return localizer.localize(scan, stamp_s, priors);
  };
  return localizeByTurns({localize}, scans, scan_done).front();
}

std::vector<DriveLocalization> localizeByTurns(const std::vector<ScanLocalizer>& localizers, ScanSource& scans,
                                               const std::function<void()>& turn_done) {
  std::vector<DriveLocalization> runs(localizers.size());
  bool all_have_references = true;
  RecordedScan scan;
  for (std::size_t i = 0; scans.next(scan); ++i) {
    all_have_references = all_have_references && scan.T_map_lidar.has_value();
    for (DriveLocalization& run : runs) {
      run.scans.push_back(scan.number);
      run.names.push_back(scan.name);
      run.failures.push_back(scan.failure);
      if (scan.T_map_lidar) run.T_map_lidar_reference.push_back(*scan.T_map_lidar);
    }
    for (std::size_t turn = 0; turn < localizers.size(); ++turn) {
      const std::size_t whose = (i + turn) % localizers.size();
      // Of a scan that could not be read there are no points: its pose is the prediction.
      LocalizationResult result = localizers[whose](viewOf(scan), scan.stamp_s, scan.priors);
      if (!scan.failure.empty()) result.acceptance = Acceptance::UNREADABLE;
      runs[whose].results.push_back(std::move(result));
      if (turn_done) turn_done();
    }
  }
  if (!all_have_references) {
    for (DriveLocalization& run : runs) run.T_map_lidar_reference.clear();
  }
  return runs;
}

}  // namespace saw_ndt
