#pragma once

#include <filesystem>
#include <memory>

#include "saw_ndt/drives/recording.h"

namespace saw_ndt::internal {

/// A recording with the reference poses of a file instead of its own; see RecordingOptions::poses_file. Poses with
/// stamps are interpolated to those of the scans; scans outside, or in a gap of more than a second, have none.
/// @throws Error where there is no such file
std::unique_ptr<Recording> withReferencePoses(std::unique_ptr<Recording> recording, const std::filesystem::path& file);

/// A recording with stamps at an even rate, the first scan's 0, instead of its own.
std::unique_ptr<Recording> withScanRate(std::unique_ptr<Recording> recording, double scan_rate_hz);

}  // namespace saw_ndt::internal
