#pragma once

#include <cstdint>
#include <vector>

#include "io/velodyne_packets.h"
#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// When packets were sent, told by the clock of the sensor, which has no jitter, and set by that of the host.
///
/// The sensor counts microseconds since the hour, of GPS or, where it has none, of its own. Where they agree with the
/// host's to a tenth of a second when the stream begins, they are taken for GPS's: times are then the sensor's, and the
/// host says which hour it is. Otherwise they are the host's of the packet that was the least delayed, from which the
/// sensor counts on; so that its clock may drift, an earlier packet weighs less by 100 us a second. A sensor whose
/// count stands still has the host's times.
class SAW_NDT_EXPORT VelodyneClock {
 public:
  /// @param host_s        when the packet came (s since 1970)
  /// @param timestamp_us  velodyneTimestamp_us()
  /// @return whether the packet follows the last one; not so for the first one, where some did not come for a quarter
  ///         of a second, or where the sensor's clock was set
  bool add(double host_s, std::uint32_t timestamp_us);

  /// Makes time_s() take what has been learned since the last call, so that times do not jump in between.
  void adjust() { offset_s_ = next_offset_s_; }
  /// Time (s since 1970) of a moment by its microseconds from the timestamp of the last packet.
  double time_s(double from_timestamp_us) const {
    return offset_s_ + 1e-6 * (static_cast<double>(elapsed_us_) + from_timestamp_us);
  }

 private:
  void begin(double host_s, std::uint32_t timestamp_us);

  bool begun_ = false;
  bool is_gps_ = false;
  std::uint32_t last_us_ = 0;
  double last_host_s_ = 0.0;
  std::int64_t elapsed_us_ = 0;  // since the first packet
  std::int64_t agreed_us_ = 0;   // when the clocks last agreed
  double offset_s_ = 0.0;        // time of the first packet
  double next_offset_s_ = 0.0;
};

/// A firing and what it is to the scans.
struct TurnFiring {
  VelodyneFiring firing;
  double time_s = 0.0;        ///< of its first laser, since 1970
  bool begins_scan = false;   ///< whether it is the first of a scan
  bool ended_a_scan = false;  ///< where it begins one: whether what it ends is a scan that is kept
};

/// Finds where the scans of a stream of data packets begin: where the azimuth passes 0. What begins or ends elsewhere,
/// at the ends of the stream or because packets are missing, is kept as a scan if it covers half a turn.
class SAW_NDT_EXPORT VelodyneTurns {
 public:
  explicit VelodyneTurns(VelodyneModel model) : model_(model) {}

  /// @param packet  kVelodynePacketBytes bytes of a data packet of the model
  /// @param host_s  when it came (s since 1970)
  /// @return its firings, valid until the next call
  const std::vector<TurnFiring>& add(const std::uint8_t* packet, double host_s);

  /// Whether the firings since the last scan began are a scan that is kept, if no more come.
  bool endsWithScan() const { return is_open_ && coversHalf(last_azimuth_); }

 private:
  bool coversHalf(double end_azimuth) const;

  VelodyneModel model_;
  VelodyneClock clock_;
  std::vector<VelodyneFiring> packet_firings_;
  std::vector<TurnFiring> firings_;
  bool is_open_ = false;  // whether there are firings since a scan began
  int packets_ = 0;       // since then
  double first_azimuth_ = 0.0;
  double last_azimuth_ = 0.0;
};

}  // namespace saw_ndt::internal
