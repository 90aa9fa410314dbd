#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/drives/drive_map.h"
#include "saw_ndt/drives/recording.h"

namespace saw_ndt::internal {

/// What was found out of one drive of a map before the long work.
struct DrivePlan {
  std::vector<int> scans;                           ///< numbers of those to be added, none perhaps
  std::optional<SegmentationOptions> segmentation;  ///< how they are segmented; none: raw points without labels
  MotionCompensation motion_compensation = MotionCompensation::OFF;
};

/// How many sums the builder of a map keeps in memory, some 130 MB.
constexpr std::size_t kMostEntriesInMemory = 1000000;

/// Opens a drive, by its number from 0 on. The recording is valid until the next call.
using DriveOpener = std::function<const Recording&(int drive)>;

/// The options by which the scans of a drive are added to a map: `common` with those of its plan, and with the motion
/// of the recording where it is to be taken out. @throws Error as Recording::stamps() and trajectory()
SAW_NDT_EXPORT DriveMapOptions optionsFor(const DrivePlan& plan, const Recording& recording, DriveMapOptions common);

/// The same options, by which the reason of the scan that was left out last is kept, too. Both must outlive them.
DriveMapOptions notingFailures(const DriveMapOptions& options, std::string& last_failure);

/// Throws an Error that tells the reason of a scan that was left out, where no other scan has been added, and where no
/// point of a scan was.
SAW_NDT_EXPORT void requireAnyPoint(const MapOrigin& origin, const std::string& last_failure);

/// Builds the map of several drives, whose poses are in one map frame, as buildDriveMap() that of one. The map tells
/// the segmentation of the first one.
/// @param plans      of the drives, one or more
/// @param common     the same for all of them
/// @param spill_folder  of a temporary file for what is more than kMostEntriesInMemory
/// @param scan_done  called after each scan, from any thread; may be empty
SAW_NDT_EXPORT WeightedMapBuilder buildMapOfDrives(const std::vector<DrivePlan>& plans, const DriveOpener& open,
                                                   const DriveMapOptions& common,
                                                   const std::filesystem::path& spill_folder,
                                                   const std::function<void()>& scan_done);

}  // namespace saw_ndt::internal
