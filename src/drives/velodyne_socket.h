#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "saw_ndt/common/export.h"
#include "saw_ndt/drives/live_source.h"

namespace saw_ndt::internal {

/// Listens for the data packets of a Velodyne from now on, and puts its scans together as they come; see
/// openVelodyneCapture() for what a scan holds. They are numbered from 0, those that next() leaves out included. Times
/// are by the system's clock when packets come, made even by that of the sensor (see VelodyneClock).
///
/// Packets of the first sender that is read are taken, until it is silent for a second. All others are rejected:
/// those of another size or kind, of a Velodyne that is not read, and of an HDL-64E without calibration. The memory is
/// that of max_waiting + 2 scans, whatever comes.
///
/// @param address      of an interface of this machine, 0.0.0.0 for all of them, or of a multicast group, which is
///                     joined
/// @param calibration  of an HDL-64E (db.xml); empty: there is none
/// @param max_waiting  see LiveSource
/// @throws Error that names address and port where they cannot be listened to, such as a port in use; as
///         VelodyneLasers
SAW_NDT_EXPORT std::unique_ptr<LiveSource> listenToVelodyne(const std::string& address, std::uint16_t port,
                                                            const std::filesystem::path& calibration = {},
                                                            std::size_t max_waiting = 1);

}  // namespace saw_ndt::internal
