#include "drives/live_address.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "expect_throws.h"

namespace saw_ndt::internal {
namespace {

void expectAddress(const std::string& text, const std::string& address, int port) {
  const auto result = parseUdpAddress(text);
  ASSERT_TRUE(result) << text;
  EXPECT_EQ(result->address, address) << text;
  EXPECT_EQ(result->port, port) << text;
}

TEST(LiveAddress, IsReadWithWhatIsLeftOut) {
  expectAddress("udp:", "0.0.0.0", 2368);
  expectAddress("udp:2369", "0.0.0.0", 2369);
  expectAddress("udp:127.0.0.1:65535", "127.0.0.1", 65535);
  expectAddress("udp:239.1.2.3:", "239.1.2.3", 2368);
  expectAddress("udp:[::1]:2368", "::1", 2368);
}

TEST(LiveAddress, OtherTextsAreNone) {
  for (const char* text : {"", "udp", "drive.pcap", "/data/udp:2368", "UDP:2368", "tcp:2368"}) {
    EXPECT_FALSE(parseUdpAddress(text)) << text;
  }
}

TEST(LiveAddress, WhatIsNoneBehindUdpIsRefused) {
  for (const char* text : {"udp:0", "udp:65536", "udp:-1", "udp:23x", "udp: 2368", "udp:lidar:2368", "udp::2368",
                           "udp:1.2.3:2368", "udp:1.2.3.4", "udp:1.2.3.4:x", "udp:::1:2368", "udp:[1.2.3.4]:2368"}) {
    SCOPED_TRACE(text);
    expectThrows<std::invalid_argument>([&] { parseUdpAddress(text); }, {text, "udp:ADDRESS:PORT"});
  }
}

}  // namespace
}  // namespace saw_ndt::internal
