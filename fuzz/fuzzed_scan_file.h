#pragma once

#include "fuzzed_file.h"
#include "saw_ndt/io/scan_file.h"

namespace saw_ndt {

/// What readers promise of every scan that they return.
inline void requireConsistent(const ScanPoints& scan) {
  const std::size_t count = scan.points.size();
  require(scan.rings.empty() || scan.rings.size() == count, "there is a ring for each point");
  require(scan.times_s.empty() || scan.times_s.size() == count, "there is a time for each point");
  require(scan.height <= 1 || scan.width * scan.height == count, "rows and columns make up the points");
}

}  // namespace saw_ndt
