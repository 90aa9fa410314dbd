#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "io/velodyne_lasers.h"
#include "io/velodyne_turns.h"
#include "saw_ndt/common/export.h"
#include "saw_ndt/common/scan_view.h"

namespace saw_ndt::internal {

/// A whole scan of a stream of packets; see openVelodyneCapture() for what it holds.
struct StreamedScan {
  ScanPoints points;
  double stamp_s = 0.0;
};

/// Puts the scans of a stream of packets of one Velodyne together. Its memory is bounded, whatever comes. Of the first
/// packet of a Velodyne that is not read it warns.
class SAW_NDT_EXPORT VelodyneStream {
 public:
  /// @param calibration  of an HDL-64E; empty: there is none, and such a sensor's packets are not taken
  /// @throws Error where it cannot be read
  explicit VelodyneStream(const std::filesystem::path& calibration = {});

  /// Takes a packet; `scan_done(StreamedScan&)` is called for the scan that it ends, whose memory may be swapped away.
  /// @param host_s  when it came (s since 1970)
  /// @return false where the payload is no data packet of a Velodyne that is read, or of another model than the first
  template <typename ScanDone>
  bool add(const std::uint8_t* payload, std::size_t size, double host_s, const ScanDone& scan_done) {
    if (!isTaken(payload, size)) return false;
    for (const TurnFiring& firing : turns_->add(payload, host_s)) {
      if (firing.ended_a_scan) {
        finish();
        scan_done(scan_);
      }
      if (firing.begins_scan) begin(firing.time_s);
      lasers_->addReturns(payload, firing.firing, firing.time_s, scan_.points);
    }
    return true;
  }

  /// Forgets the scan that has begun, and the model: another sensor may send from now on.
  void restart();

 private:
  bool isTaken(const std::uint8_t* payload, std::size_t size);
  void warnOnce(const std::string& reason);
  void begin(double stamp_s);
  void finish();

  std::optional<VelodyneLasers> calibrated_;  // of an HDL-64E
  std::optional<VelodyneLasers> uncalibrated_;
  const VelodyneLasers* lasers_ = nullptr;  // one of these, of the sensor that sends
  std::optional<VelodyneTurns> turns_;
  StreamedScan scan_;
  bool has_warned_ = false;
};

}  // namespace saw_ndt::internal
