#pragma once

#include <cmath>

#include "fuzzed_scan_file.h"
#include "saw_ndt/drives/recording.h"

namespace saw_ndt {

/// Reads all that a recording tells and its first scans.
inline void readAll(const Recording& recording) {
  constexpr int kMostScans = 8;
  if (recording.hasStamps()) {
    for (const double stamp_s : recording.stamps()) require(std::isfinite(stamp_s), "stamps are finite");
  }
  ScanPoints points;
  for (int scan = 0; scan < recording.scanCount() && scan < kMostScans; ++scan) {
    try {
      recording.readScan(scan, points);
      requireConsistent(points);
    } catch (const Error&) {  // the next one can be read all the same
    }
    if (!recording.hasPoses()) continue;
    const auto T_map_lidar = recording.referencePose(scan);
    require(!T_map_lidar || T_map_lidar->matrix().allFinite(), "poses are finite");
  }
}

inline void tryReadingRecording(FuzzedFile& file, const std::uint8_t* data, std::size_t size,
                                const RecordingOptions& options = {}) {
  file.tryReading(data, size, [&](const std::filesystem::path& path) { readAll(*openRecording(path, options)); });
}

}  // namespace saw_ndt
