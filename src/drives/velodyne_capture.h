#pragma once

#include <filesystem>
#include <memory>

#include "io/capture_magic.h"
#include "saw_ndt/common/export.h"
#include "saw_ndt/drives/recording.h"

namespace saw_ndt::internal {

/// Opens a capture (see isCapture()) of the data packets of a Velodyne: a VLP-16, HDL-32E, or HDL-64E with
/// options.velodyne_calibration. Other packets are passed over. It is read once from end to end to find the scans; each
/// is read again, in constant memory, when it is asked for. Where the file is cut short, scans end there.
///
/// A scan is a turn from azimuth 0 to azimuth 0, points in the order in which they were measured. The first and last
/// one are left out if they cover less than half a turn. Its stamp is the time of its first firing, when the LiDAR
/// looks along x; times of points are absolute, like stamps: seconds since 1970 by the clock of the capture, made even
/// by that of the sensor (see VelodyneClock). Its rings are numbered from the bottom. See VelodyneLasers for the frame.
///
/// Where several sensors were captured, options.topic is the address of the one to read, such as 192.168.1.201; else
/// it is the one with the most packets.
///
/// @throws Error where the file cannot be read, holds no data packets or no scan, or those of a Velodyne that is not
///         read, which it names; where no sensor has the address; as VelodyneLasers
SAW_NDT_EXPORT std::unique_ptr<Recording> openVelodyneCapture(const std::filesystem::path& path,
                                                              const RecordingOptions& options = {});

}  // namespace saw_ndt::internal
