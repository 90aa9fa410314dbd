#include "io/velodyne_stream.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>

#include "io/velodyne_sensor.h"

namespace saw_ndt::internal {
namespace {

TEST(VelodyneStream, GivesWholeScans) {
  VelodyneStream stream;
  const TurningVlp16 sensor;
  std::vector<StreamedScan> scans;
  for (int i = 0; i < 300; ++i) {
    const VelodynePacket packet = sensor.packet(i);
    EXPECT_TRUE(stream.add(packet.data(), VelodynePacket::size(), TurningVlp16::time_s(i),
                           [&](StreamedScan& scan) { scans.push_back(std::move(scan)); }));
  }
  ASSERT_EQ(scans.size(), 3U);
  for (const StreamedScan& scan : scans) {
    EXPECT_NEAR(static_cast<double>(scan.points.points.size()), 16 * 1808.4, 17.0);
    EXPECT_EQ(scan.points.width, scan.points.points.size());
    EXPECT_EQ(scan.points.times_s.front(), scan.stamp_s);
  }
}

TEST(VelodyneStream, TakesNoneButTheFirstModelUntilItIsRestarted) {
  VelodyneStream stream;
  const auto takes = [&](const VelodynePacket& packet) {
    return stream.add(packet.data(), VelodynePacket::size(), 0.0, [](StreamedScan&) {});
  };
  EXPECT_FALSE(takes(VelodynePacket(0x37, 0x28)));
  EXPECT_FALSE(takes(VelodynePacket::ofHdl64e()));
  EXPECT_TRUE(takes(VelodynePacket::ofHdl32e()));
  EXPECT_FALSE(takes(VelodynePacket::ofVlp16()));
  stream.restart();
  EXPECT_TRUE(takes(VelodynePacket::ofVlp16()));
}

TEST(VelodyneStream, IsBoundedWhateverPacketsHold) {
  VelodyneStream stream;
  std::mt19937 random(1);
  std::size_t most = 0;
  for (int i = 0; i < 20000; ++i) {
    VelodynePacket packet(random() % 2 == 0 ? 0x37 : 0x39, 0x22);
    for (std::size_t block = 0; block < 12; ++block) {
      packet.setAzimuth(block, random() % 65536);
      packet.setReturn(block, random() % 32, random() % 65536, static_cast<std::uint8_t>(random()));
    }
    packet.setTimestamp(static_cast<std::uint32_t>(random()));
    const double host_s = i % 3 == 0 ? 1e9 * static_cast<double>(random() % 5) : 1e-3 * i;
    stream.add(packet.data(), VelodynePacket::size(), host_s,
               [&](StreamedScan& scan) { most = std::max(most, scan.points.points.size()); });
  }
  EXPECT_LE(most, 2501U * 384U);
}

}  // namespace
}  // namespace saw_ndt::internal
