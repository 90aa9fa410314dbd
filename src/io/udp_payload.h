#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// What a captured frame holds.
struct UdpPayload {
  enum class Kind {
    UDP,       ///< a whole UDP packet over IPv4
    FRAGMENT,  ///< a part of one, which is not put together
    OTHER,     ///< anything else, also a frame that is cut short
  };

  Kind kind = Kind::OTHER;
  std::uint32_t source_address = 0;  ///< of IPv4, the first number in the highest byte
  const std::uint8_t* bytes = nullptr;
  std::size_t size = 0;
};

/// How frames begin, by what they were captured from.
enum class LinkLayer { ETHERNET, LINUX_COOKED, LINUX_COOKED_2, LOOPBACK, IP };

/// Finds the payload of a frame, behind VLAN tags where there are any.
/// @param frame  what was captured of it; the payload points into it
SAW_NDT_EXPORT UdpPayload udpPayload(LinkLayer link, const std::uint8_t* frame, std::size_t size);

/// An address as usually written, such as 192.168.1.201.
SAW_NDT_EXPORT std::string ipv4Text(std::uint32_t address);

}  // namespace saw_ndt::internal
