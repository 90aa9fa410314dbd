#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "saw_ndt/common/export.h"

namespace saw_ndt::internal {

/// Where packets of a LiDAR come in.
struct LiveAddress {
  std::string address =
      "0.0.0.0";              ///< of an interface of this machine, or of a multicast group; 0.0.0.0: any interface
  std::uint16_t port = 2368;  ///< UDP; Velodyne's own by default
};

/// Reads `udp:`, `udp:PORT`, `udp:ADDRESS:PORT` or `udp:ADDRESS:`; an address of IPv6 is written in brackets.
/// @return nothing where the text does not begin with `udp:`
/// @throws std::invalid_argument that quotes the text where it does, and what follows is no such address
SAW_NDT_EXPORT std::optional<LiveAddress> parseUdpAddress(const std::string& text);

}  // namespace saw_ndt::internal
