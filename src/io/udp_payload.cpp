#include "io/udp_payload.h"

namespace saw_ndt::internal {

namespace {

constexpr unsigned kIpv4 = 0x0800;
constexpr unsigned kVlan = 0x8100;
constexpr unsigned kOuterVlan = 0x88A8;
constexpr unsigned kUdp = 17;
constexpr std::size_t kVlanBytes = 4;
constexpr std::size_t kLeastIpBytes = 20;
constexpr std::size_t kUdpBytes = 8;

unsigned readBigEndian16(const std::uint8_t* bytes) { return static_cast<unsigned>(bytes[0]) << 8 | bytes[1]; }

/// Where a frame of a link layer states what it holds, and where that begins.
struct Framing {
  std::size_t type_offset;
  std::size_t bytes;
};

constexpr Framing framingOf(LinkLayer link) {
  switch (link) {
    case LinkLayer::ETHERNET:
      return {12, 14};
    case LinkLayer::LINUX_COOKED:
      return {14, 16};
    case LinkLayer::LINUX_COOKED_2:
      return {0, 20};
    case LinkLayer::LOOPBACK:
      return {0, 4};
    case LinkLayer::IP:
      break;
  }
  return {0, 0};
}

/// Where the IP packet of a frame begins; its size where it holds none.
std::size_t ipOffset(LinkLayer link, const std::uint8_t* frame, std::size_t size) {
  const Framing framing = framingOf(link);
  std::size_t offset = framing.bytes;
  if (offset >= size) return size;
  // The number that a loopback device has for IPv4 depends on the machine; the packet itself says what it is.
  if (link == LinkLayer::LOOPBACK || link == LinkLayer::IP) return offset;
  unsigned type = readBigEndian16(frame + framing.type_offset);
  while ((type == kVlan || type == kOuterVlan) && offset + kVlanBytes <= size) {
    type = readBigEndian16(frame + offset + 2);
    offset += kVlanBytes;
  }
  return type == kIpv4 ? offset : size;
}

}  // namespace

UdpPayload udpPayload(LinkLayer link, const std::uint8_t* frame, std::size_t size) {
  UdpPayload payload;
  const std::size_t offset = ipOffset(link, frame, size);
  const std::uint8_t* const ip = frame + offset;
  const std::size_t left = size - offset;
  if (left < kLeastIpBytes || ip[0] >> 4 != 4 || ip[9] != kUdp) return payload;
  const std::size_t ip_bytes = (ip[0] & 0x0FU) * std::size_t{4};
  const std::size_t total = readBigEndian16(ip + 2);
  if (ip_bytes < kLeastIpBytes) return payload;
  payload.source_address = static_cast<std::uint32_t>(readBigEndian16(ip + 12)) << 16 | readBigEndian16(ip + 14);
  constexpr unsigned kMoreFragmentsOrOffset = 0x3FFF;
  if ((readBigEndian16(ip + 6) & kMoreFragmentsOrOffset) != 0) {
    payload.kind = UdpPayload::Kind::FRAGMENT;
    return payload;
  }
  if (total > left || total < ip_bytes + kUdpBytes) return payload;
  const std::size_t udp_bytes = readBigEndian16(ip + ip_bytes + 4);
  if (udp_bytes < kUdpBytes || udp_bytes > total - ip_bytes) return payload;
  payload.kind = UdpPayload::Kind::UDP;
  payload.bytes = ip + ip_bytes + kUdpBytes;
  payload.size = udp_bytes - kUdpBytes;
  return payload;
}

std::string ipv4Text(std::uint32_t address) {
  return std::to_string(address >> 24) + "." + std::to_string(address >> 16 & 0xFFU) + "." +
         std::to_string(address >> 8 & 0xFFU) + "." + std::to_string(address & 0xFFU);
}

}  // namespace saw_ndt::internal
