#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "io/velodyne_packets.h"

namespace saw_ndt {

/// A data packet that a test fills in.
class VelodynePacket {
 public:
  VelodynePacket(std::uint8_t mode, std::uint8_t product) {
    for (std::size_t block = 0; block < 12; ++block) setIdentifier(block, 0xEEFF);
    bytes_[1204] = mode;
    bytes_[1205] = product;
  }
  static VelodynePacket ofVlp16() { return {0x37, 0x22}; }
  static VelodynePacket ofHdl32e() { return {0x37, 0x21}; }
  static VelodynePacket ofHdl64e() {
    VelodynePacket packet(0x48, 0x02);
    for (std::size_t block = 1; block < 12; block += 2) packet.setIdentifier(block, 0xDDFF);
    return packet;
  }

  void setIdentifier(std::size_t block, unsigned identifier) { set16(block * 100, identifier); }
  void setAzimuth(std::size_t block, unsigned azimuth) { set16(block * 100 + 2, azimuth); }
  void setReturn(std::size_t block, std::size_t channel, unsigned distance, std::uint8_t intensity) {
    set16(block * 100 + 4 + channel * 3, distance);
    bytes_[block * 100 + 4 + channel * 3 + 2] = intensity;
  }
  void setTimestamp(std::uint32_t us) {
    set16(1200, us & 0xFFFFU);
    set16(1202, us >> 16);
  }

  const std::uint8_t* data() const { return bytes_.data(); }
  static constexpr std::size_t size() { return internal::kVelodynePacketBytes; }

 private:
  void set16(std::size_t offset, unsigned value) {
    bytes_[offset] = static_cast<std::uint8_t>(value & 0xFFU);
    bytes_[offset + 1] = static_cast<std::uint8_t>(value >> 8);
  }

  std::array<std::uint8_t, internal::kVelodynePacketBytes> bytes_{};
};

/// A VLP-16 that turns once in 0.1 s and sees a wall 10 m away all around by every laser; intensity tells the turn.
class TurningVlp16 {
 public:
  static constexpr double kPacket_s = 24 * 55.296e-6;
  static constexpr double kTurn_s = 0.1;

  /// @param azimuth  where it looks at its first firing (0.01 degrees)
  /// @param clock_us of the sensor, at the first firing
  explicit TurningVlp16(double azimuth = 0.0, std::uint64_t clock_us = 0) : azimuth_(azimuth), clock_us_(clock_us) {}

  /// When the first laser of a packet fires, from that of packet 0 (s).
  static double time_s(int packet) { return packet * kPacket_s; }

  VelodynePacket packet(int number) const {
    VelodynePacket packet = VelodynePacket::ofVlp16();
    for (std::size_t block = 0; block < 12; ++block) {
      const double turns = azimuth_ / 36000.0 + (time_s(number) + static_cast<double>(block) * 110.592e-6) / kTurn_s;
      packet.setAzimuth(block, static_cast<unsigned>((turns - std::floor(turns)) * 36000.0));
      for (std::size_t channel = 0; channel < 32; ++channel) {
        packet.setReturn(block, channel, 5000, static_cast<std::uint8_t>(turns));
      }
    }
    const auto us = clock_us_ + static_cast<std::uint64_t>(std::llround(1e6 * time_s(number)));
    packet.setTimestamp(static_cast<std::uint32_t>(us % 3'600'000'000));
    return packet;
  }

 private:
  double azimuth_;
  std::uint64_t clock_us_;
};

}  // namespace saw_ndt
