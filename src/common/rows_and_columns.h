#pragma once

#include "saw_ndt/common/scan_view.h"

namespace saw_ndt::internal {

/// Whether the points of a scan are in rows and columns. By division, which does not wrap round.
inline bool isOrganized(const ScanView& scan) {
  return scan.height > 1 && scan.size % scan.height == 0 && scan.width == scan.size / scan.height;
}

}  // namespace saw_ndt::internal
