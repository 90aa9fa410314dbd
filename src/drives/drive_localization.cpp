#include "saw_ndt/drives/drive_localization.h"

namespace saw_ndt {

namespace {

/// Adds a scan and what was found of it.
void add(const RecordedScan& scan, LocalizationResult result, DriveLocalization& run) {
  run.scans.push_back(scan.number);
  run.names.push_back(scan.name);
  run.failures.push_back(scan.failure);
  run.T_map_lidar_reference.push_back(scan.T_map_lidar);
  run.results.push_back(std::move(result));
}

// Of a scan that could not be read there are no points: its pose is the prediction.
LocalizationResult localized(const ScanLocalizer& localizer, const RecordedScan& scan) {
  LocalizationResult result = localizer(viewOf(scan), scan.stamp_s, scan.priors);
  if (!scan.failure.empty()) result.acceptance = Acceptance::UNREADABLE;
  return result;
}

}  // namespace

DriveLocalization localizeDrive(Localizer& localizer, ScanSource& scans,
                                const std::function<void(const RecordedScan&, const LocalizationResult&)>& scan_done) {
  const ScanLocalizer localize = [&](const ScanView& scan, double stamp_s, const ScanPriors& priors) {
    return localizer.localize(scan, stamp_s, priors);
  };
  DriveLocalization run;
  RecordedScan scan;
  while (scans.next(scan)) {
    add(scan, localized(localize, scan), run);
    if (scan_done) scan_done(scan, run.results.back());
  }
  return run;
}

std::vector<DriveLocalization> localizeByTurns(const std::vector<ScanLocalizer>& localizers, ScanSource& scans,
                                               const std::function<void()>& turn_done) {
  std::vector<DriveLocalization> runs(localizers.size());
  RecordedScan scan;
  for (std::size_t i = 0; scans.next(scan); ++i) {
    for (std::size_t turn = 0; turn < localizers.size(); ++turn) {
      const std::size_t whose = (i + turn) % localizers.size();
      add(scan, localized(localizers[whose], scan), runs[whose]);
      if (turn_done) turn_done();
    }
  }
  return runs;
}

}  // namespace saw_ndt
