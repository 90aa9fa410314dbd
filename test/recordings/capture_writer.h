#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "io/udp_payload.h"

namespace saw_ndt {

/// Writes captures for tests, in the format of pcap or pcapng.
class CaptureWriter {
 public:
  enum class Format { PCAP, PCAP_NANOSECONDS, PCAPNG };

  /// @param link_type  as the files number it
  explicit CaptureWriter(std::uint32_t link_type = 1, Format format = Format::PCAP) : format_(format) {
    if (format == Format::PCAPNG) {
      add32(0x0A0D0D0A), add32(28), add32(0x1A2B3C4D), add16(1), add16(0);
      add32(0xFFFFFFFF), add32(0xFFFFFFFF), add32(28);
      add32(1), add32(20), add16(link_type), add16(0), add32(65535), add32(20);
      return;
    }
    add32(format == Format::PCAP ? 0xA1B2C3D4 : 0xA1B23C4D);
    add16(2), add16(4), add32(0), add32(0), add32(65535), add32(link_type);
  }

  /// Adds a frame that was captured whole.
  void add(const std::string& frame, double time_s) {
    const auto size = static_cast<std::uint32_t>(frame.size());
    const double whole_s = std::floor(time_s);
    if (format_ == Format::PCAPNG) {
      const std::uint32_t padding = (4 - size % 4) % 4;
      const auto us = static_cast<std::uint64_t>(whole_s) * 1'000'000 +
                      static_cast<std::uint64_t>(std::llround((time_s - whole_s) * 1e6));
      add32(6), add32(32 + size + padding), add32(0), add32(static_cast<std::uint32_t>(us >> 32));
      add32(static_cast<std::uint32_t>(us & 0xFFFFFFFF)), add32(size), add32(size);
      content_ += frame + std::string(padding, '\0');
      add32(32 + size + padding);
      return;
    }
    const double parts = format_ == Format::PCAP ? 1e6 : 1e9;
    add32(static_cast<std::uint32_t>(whole_s));
    add32(static_cast<std::uint32_t>((time_s - whole_s) * parts));
    add32(size), add32(size);
    content_ += frame;
  }

  const std::string& content() const { return content_; }
  void write(const std::filesystem::path& path) const { std::ofstream(path, std::ios::binary) << content_; }

 private:
  void add16(std::uint32_t value) {
    content_ += static_cast<char>(value & 0xFFU);
    content_ += static_cast<char>(value >> 8 & 0xFFU);
  }
  void add32(std::uint32_t value) {
    add16(value & 0xFFFFU);
    add16(value >> 16);
  }

  Format format_;
  std::string content_;
};

/// An IPv4 packet that holds a UDP one.
/// @param address   of the sender, its last number; it begins with 192.168.1
/// @param fragment  what the field of flags and fragment offset holds
inline std::string ipPacket(const std::string& payload, int address = 201, unsigned fragment = 0) {
  std::string bytes;
  const auto add16 = [&](std::size_t value) {
    bytes += static_cast<char>(value >> 8 & 0xFFU);
    bytes += static_cast<char>(value & 0xFFU);
  };
  add16(0x4500), add16(28 + payload.size()), add16(0), add16(fragment), add16(0x4011), add16(0);
  add16(192 << 8 | 168), add16(static_cast<std::size_t>(1 << 8 | address)), add16(0xFFFF), add16(0xFFFF);
  add16(2368), add16(2368), add16(8 + payload.size()), add16(0);
  return bytes + payload;
}

inline std::string ethernetFrame(const std::string& ip_packet, const std::string& type = std::string("\x08\x00", 2)) {
  return std::string(12, '\x11') + type + ip_packet;
}

}  // namespace saw_ndt
