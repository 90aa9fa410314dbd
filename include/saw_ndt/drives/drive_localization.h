#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/drives/scan_source.h"
#include "saw_ndt/localization/localizer.h"

namespace saw_ndt {

/// A drive localized scan by scan; one element a scan, in order.
struct DriveLocalization {
  std::vector<int> scans;             ///< numbers
  std::vector<std::string> names;     ///< see RecordedScan::name
  std::vector<std::string> failures;  ///< why a scan could not be read, empty where it could
  std::vector<LocalizationResult> results;
  std::vector<std::optional<Eigen::Isometry3d>> T_map_lidar_reference;  ///< reference poses, as far as there are any
};

/// Localizes the scans of a source one after the other. Reading a scan is no part of its times. A scan that cannot be
/// read is rejected as Acceptance::UNREADABLE.
/// @param scan_done  called after each scan with what was found; may be empty
SAW_NDT_EXPORT DriveLocalization
localizeDrive(Localizer& localizer, ScanSource& scans,
              const std::function<void(const RecordedScan&, const LocalizationResult&)>& scan_done = {});

/// One way of localizing a scan: that of a Localizer, or one to compare it with.
using ScanLocalizer = std::function<LocalizationResult(const ScanView& scan, double stamp_s, const ScanPriors& priors)>;

/// The same for several methods at once. They take turns at every scan, another one first each time, so that a slow
/// moment of the machine hits all of them; a scan is read once.
/// @param turn_done  called after each turn, scans times methods in all; may be empty
/// @return one run a method, in their order
SAW_NDT_EXPORT std::vector<DriveLocalization> localizeByTurns(const std::vector<ScanLocalizer>& localizers,
                                                              ScanSource& scans,
                                                              const std::function<void()>& turn_done = {});

}  // namespace saw_ndt
