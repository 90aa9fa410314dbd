#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "saw_ndt/common/scan_view.h"
#include "saw_ndt/drives/recording.h"
#include "simulation/random_numbers.h"

namespace saw_ndt {

/// What goes wrong in an endless drive.
enum class DriveFault {
  NONE,
  DROPPED,        ///< up to ten scans are missing
  EMPTY,          ///< a scan has no point
  NOT_A_NUMBER,   ///< no coordinate of a scan is a number
  ZEROS,          ///< every point of a scan is the origin
  REPEATED,       ///< a scan comes once more, with the same stamp
  REPEATED_NEXT,  ///< a scan comes once more, with the next stamp
  BLINDED,        ///< next to nothing is seen for some seconds
  KIDNAPPED,      ///< the vehicle is somewhere else along the way
};
constexpr std::size_t kDriveFaults = 9;  ///< NONE included

/// "dropped", "empty" and so on
const char* toString(DriveFault fault);

/// Drives a recording again and again, with faults: at the end of the way the vehicle is at its beginning again, which
/// is a kidnapping as well. Stamps grow all the time, by one period a scan.
class EndlessDrive {
 public:
  /// @param recording      with reference poses
  /// @param fault_scans    a fault begins after so many scans, on average; 0: none but that at the end of the way
  EndlessDrive(const Recording& recording, std::size_t fault_scans, std::uint64_t seed);

  /// Goes on to the next scan.
  void next();

  const ScanPoints& scan() const { return altered_; }
  double stamp() const { return stamp_s_; }
  /// Where the vehicle was when the scan was taken.
  const Eigen::Isometry3d& truth() const { return T_map_lidar_; }
  /// How often each fault began.
  const std::array<std::size_t, kDriveFaults>& faults() const { return faults_; }

 private:
  void begin(DriveFault fault);
  void advance(int scans);
  void read(int number);

  const Recording& recording_;
  std::size_t fault_scans_;
  SceneRandom random_;
  double period_s_ = 0.0;
  int number_ = -1;
  double stamp_s_ = 0.0;
  int blinded_scans_ = 0;  // that are still to come
  double blinded_from_rad_ = 0.0;
  ScanPoints scan_, altered_;
  Eigen::Isometry3d T_map_lidar_ = Eigen::Isometry3d::Identity();
  std::array<std::size_t, kDriveFaults> faults_{};
};

}  // namespace saw_ndt
