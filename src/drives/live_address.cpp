#include "drives/live_address.h"

#include <boost/asio/ip/address.hpp>
#include <charconv>
#include <stdexcept>
#include <string_view>

namespace saw_ndt::internal {

std::optional<LiveAddress> parseUdpAddress(const std::string& text) {
  constexpr std::string_view kScheme = "udp:";
  if (text.compare(0, kScheme.size(), kScheme) != 0) return std::nullopt;
  const auto refuse = [&](const std::string& reason) {
    throw std::invalid_argument(text + ": " + reason + "; expected udp:PORT or udp:ADDRESS:PORT");
  };

  LiveAddress result;
  std::string port = text.substr(kScheme.size());
  const std::size_t colon = port.rfind(':');
  if (colon != std::string::npos) {
    std::string address = port.substr(0, colon);
    port.erase(0, colon + 1);
    const bool in_brackets = address.size() > 2 && address.front() == '[' && address.back() == ']';
    if (in_brackets) address = address.substr(1, address.size() - 2);
    boost::system::error_code error;
    const boost::asio::ip::address parsed = boost::asio::ip::make_address(address, error);
    if (error || parsed.is_v6() != in_brackets) refuse("'" + address + "' is no IP address");
    result.address = address;
  }
  if (port.empty()) return result;
  const char* const end = port.data() + port.size();
  const auto [last, error] = std::from_chars(port.data(), end, result.port);
  if (error != std::errc() || last != end || result.port == 0) refuse("'" + port + "' is no port, 1 to 65535");
  return result;
}

}  // namespace saw_ndt::internal
