#pragma once

#include <cstddef>
#include <fstream>
#include <ostream>
#include <string>

#include "saw_ndt/drives/scan_source.h"
#include "saw_ndt/localization/localizer.h"

namespace saw_ndt {

enum class PoseStreamFormat {
  JSON,  ///< an object a line
  TUM,   ///< a line of TUM format, and before it a comment with what that format has no place for
};

/// Poses of the base as they are found: each is written at once, for another program to read.
class PoseStream {
 public:
  /// @param file  is made or overwritten, or is a pipe; `-` for stdout
  /// @throws Error where it cannot be opened
  PoseStream(const std::string& file, PoseStreamFormat format);

  /// Writes what is known of a scan, and flushes it. TUM format has no pose where none is known.
  /// @param left_out  scans before this one that were left out for being late
  /// @return whether it could be written
  bool write(const RecordedScan& scan, const LocalizationResult& result, std::size_t left_out);

 private:
  std::ofstream file_;
  std::ostream* stream_;
  PoseStreamFormat format_;
};

}  // namespace saw_ndt
