#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "saw_ndt/common/export.h"
#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/localization/motion_prediction.h"

namespace saw_ndt {

/// A scan of a recording and what is known of it.
struct RecordedScan : ScanPoints {
  int number = 0;                                ///< within the recording, from 0
  std::string name;                              ///< its own name, for messages, such as 000012.bin
  double stamp_s = 0.0;                          ///< time of the scan
  std::optional<Eigen::Isometry3d> T_map_lidar;  ///< reference pose
  ScanPriors priors;                             ///< what other sensors measured
  std::string failure;                           ///< why the points could not be read, empty where they could
};

/// Scans one after the other, of a recording of whatever kind. Not to be shared by threads.
class SAW_NDT_EXPORT ScanSource {
 public:
  virtual ~ScanSource() = default;

  /// Reads the next scan, into memory that `scan` may bring along. A scan whose points cannot be read is told by its
  /// `failure`, and the one behind it can be read all the same.
  /// @return false where there are no more scans; `scan` is then left as it is
  virtual bool next(RecordedScan& scan) = 0;

  /// How many scans there are in all, where that is known.
  virtual std::optional<std::size_t> scanCount() const = 0;
};

}  // namespace saw_ndt
