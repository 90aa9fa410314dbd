#pragma once

#include <cstddef>

#include "saw_ndt/drives/scan_source.h"

namespace saw_ndt {

/// Scans of a source that does not end by itself, as they come: next() waits for a scan that it has not given yet, and
/// returns false once the source is stopped. As many as `max_waiting` of its maker may wait for a caller that is busy;
/// where more do, it is late, and gets the newest one instead of all of them. One thread calls next(); all
/// else is for any thread.
class SAW_NDT_EXPORT LiveSource : public ScanSource {
 public:
  std::optional<std::size_t> scanCount() const override { return std::nullopt; }

  /// Ends the source: next() returns false from now on, also where another thread waits in it.
  virtual void stop() = 0;
  /// How many scans next() has left out for newer ones.
  virtual std::size_t leftOut() const = 0;
  /// What came and was no part of a scan, such as packets of another sensor.
  virtual std::size_t rejected() const = 0;
};

}  // namespace saw_ndt
