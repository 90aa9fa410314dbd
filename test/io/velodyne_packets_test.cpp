#include "io/velodyne_packets.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "io/velodyne_lasers.h"
#include "io/velodyne_sensor.h"
#include "saw_ndt/common/geometry.h"

namespace saw_ndt::internal {
namespace {

std::vector<VelodyneFiring> firingsOf(const VelodynePacket& packet, VelodyneModel model) {
  std::vector<VelodyneFiring> firings;
  readVelodyneFirings(packet.data(), model, firings);
  return firings;
}

ScanPoints pointsOf(const VelodynePacket& packet, const VelodyneLasers& lasers) {
  ScanPoints scan;
  for (const VelodyneFiring& firing : firingsOf(packet, lasers.model())) {
    lasers.addReturns(packet.data(), firing, 1e-6 * firing.time_us, scan);
  }
  return scan;
}

void expectPoint(const LidarPoint& point, double distance_m, double azimuth_deg, double elevation_deg) {
  const double azimuth = radiansFromDegrees(azimuth_deg), elevation = radiansFromDegrees(elevation_deg);
  EXPECT_NEAR(point.x, distance_m * std::cos(elevation) * std::cos(azimuth), 1e-5);
  EXPECT_NEAR(point.y, -distance_m * std::cos(elevation) * std::sin(azimuth), 1e-5);
  EXPECT_NEAR(point.z, distance_m * std::sin(elevation), 1e-5);
}

void setAzimuths(VelodynePacket& packet, unsigned first, unsigned step, std::size_t blocks_a_step = 1) {
  for (std::size_t block = 0; block < 12; ++block) {
    packet.setAzimuth(block, (first + step * static_cast<unsigned>(block / blocks_a_step)) % 36000);
  }
}

TEST(VelodyneProducts, AreToldByBlocksAndFactoryBytes) {
  const auto modelOf = [](const VelodynePacket& packet) {
    const auto product = velodyneProduct(packet.data(), VelodynePacket::size());
    return product ? product->model : std::nullopt;
  };
  EXPECT_EQ(modelOf(VelodynePacket::ofVlp16()), VelodyneModel::VLP_16);
  EXPECT_EQ(modelOf(VelodynePacket::ofHdl32e()), VelodyneModel::HDL_32E);
  EXPECT_EQ(modelOf(VelodynePacket::ofHdl64e()), VelodyneModel::HDL_64E);

  const VelodynePacket vlp_32c(0x37, 0x28);
  const auto product = velodyneProduct(vlp_32c.data(), VelodynePacket::size());
  ASSERT_TRUE(product);
  EXPECT_FALSE(product->model);
  EXPECT_EQ(product->id, 0x28);
  EXPECT_NE(unreadProduct(product->id).find("0x28 (VLP-32C)"), std::string::npos);

  VelodynePacket alpha_prime(0x37, 0xA1);
  for (std::size_t block = 0; block < 12; ++block) {
    alpha_prime.setIdentifier(block, 0xEEFF - 0x1100 * static_cast<unsigned>(block % 4));
  }
  ASSERT_TRUE(velodyneProduct(alpha_prime.data(), VelodynePacket::size()));
  EXPECT_FALSE(modelOf(alpha_prime));
}

TEST(VelodyneProducts, OtherPacketsAreNone) {
  VelodynePacket packet = VelodynePacket::ofVlp16();
  EXPECT_FALSE(velodyneProduct(packet.data(), 512));
  EXPECT_FALSE(velodyneProduct(packet.data(), 0));
  packet.setIdentifier(11, 0xEEFE);
  EXPECT_FALSE(velodyneProduct(packet.data(), VelodynePacket::size()));
}

TEST(Vlp16Packet, AReturnHasItsPlaceRingAndTime) {
  const VelodyneLasers lasers(VelodyneModel::VLP_16);
  VelodynePacket packet = VelodynePacket::ofVlp16();
  setAzimuths(packet, 1000, 40);
  packet.setReturn(3, 0, 5000, 77);        // laser 0, 15 degrees below the horizon
  packet.setReturn(3, 16 + 15, 10000, 8);  // laser 15 of the block's second firing, 15 above it
  const ScanPoints scan = pointsOf(packet, lasers);
  ASSERT_EQ(scan.points.size(), 2U);
  expectPoint(scan.points[0], 10.0, 11.2, -15.0);
  EXPECT_EQ(scan.points[0].intensity, 77.0F);
  EXPECT_EQ(scan.rings[0], 0);
  EXPECT_NEAR(scan.times_s[0], 3 * 110.592e-6, 1e-12);
  // (55.296 + 15 * 2.304) / 110.592 of a step of 0.4 degrees is 0.325, by table of 0.01 degrees 0.33.
  expectPoint(scan.points[1], 20.0, 11.53, 15.0);
  EXPECT_EQ(scan.rings[1], 15);
  EXPECT_NEAR(scan.times_s[1], 3 * 110.592e-6 + 55.296e-6 + 15 * 2.304e-6, 1e-12);
}

TEST(Vlp16Packet, AzimuthZeroIsForwardAndGrowsClockwise) {
  const VelodyneLasers lasers(VelodyneModel::VLP_16);
  VelodynePacket packet = VelodynePacket::ofVlp16();
  setAzimuths(packet, 0, 0);
  packet.setAzimuth(6, 9000);
  packet.setReturn(0, 1, 500, 0);
  packet.setReturn(6, 1, 500, 0);
  const ScanPoints scan = pointsOf(packet, lasers);
  ASSERT_EQ(scan.points.size(), 2U);
  expectPoint(scan.points[0], 1.0, 0.0, 1.0);
  EXPECT_GT(scan.points[0].x, 0.99F);
  EXPECT_LT(scan.points[1].y, -0.99F);
}

TEST(Vlp16Packet, RingsGrowWithElevation) {
  const VelodyneLasers lasers(VelodyneModel::VLP_16);
  VelodynePacket packet = VelodynePacket::ofVlp16();
  for (std::size_t laser = 0; laser < 16; ++laser) packet.setReturn(0, laser, 5000, 1);
  ScanPoints scan = pointsOf(packet, lasers);
  ASSERT_EQ(scan.points.size(), 16U);
  for (std::size_t i = 0; i < 16; ++i) {
    EXPECT_NEAR(scan.points[i].z, 10.0 * std::sin(radiansFromDegrees(-15.0 + 2.0 * scan.rings[i])), 1e-5);
  }
}

TEST(Vlp16Packet, TheAzimuthGrowsAsBeforeBehindTheLastBlockAndPastZero) {
  VelodynePacket packet = VelodynePacket::ofVlp16();
  setAzimuths(packet, 35560, 40);
  const auto firings = firingsOf(packet, VelodyneModel::VLP_16);
  ASSERT_EQ(firings.size(), 24U);
  EXPECT_NEAR(firings[21].azimuth, 35980.0, 1e-9);
  EXPECT_NEAR(firings[22].azimuth, 0.0, 1e-9);
  EXPECT_NEAR(firings[23].azimuth, 20.0, 1e-9);
  EXPECT_NEAR(firings[23].time_us, 23 * 55.296, 1e-9);
}

TEST(Vlp16Packet, AnAzimuthOutOfRangeIsWrapped) {
  const VelodyneLasers lasers(VelodyneModel::VLP_16);
  VelodynePacket packet = VelodynePacket::ofVlp16();
  setAzimuths(packet, 0, 0);
  for (std::size_t block = 0; block < 12; ++block) {
    packet.setAzimuth(block, 65535);
    for (std::size_t channel = 0; channel < 32; ++channel) packet.setReturn(block, channel, 65535, 255);
  }
  for (const LidarPoint& point : pointsOf(packet, lasers).points) {
    EXPECT_NEAR(std::hypot(std::hypot(point.x, point.y), point.z), 131.07, 1e-3);
  }
}

TEST(Vlp16Packet, OfTwoReturnsTheMoreIntenseOneIsKept) {
  const VelodyneLasers lasers(VelodyneModel::VLP_16);
  VelodynePacket packet(0x39, 0x22);
  setAzimuths(packet, 1000, 40, 2);
  packet.setReturn(2, 0, 5000, 10), packet.setReturn(3, 0, 4000, 90);  // last, strongest
  packet.setReturn(2, 2, 5000, 50), packet.setReturn(3, 2, 4000, 40);
  packet.setReturn(2, 4, 5000, 50);
  packet.setReturn(3, 6, 4000, 0);
  const ScanPoints scan = pointsOf(packet, lasers);
  ASSERT_EQ(scan.points.size(), 4U);
  expectPoint(scan.points[0], 8.0, 10.4, -15.0);
  EXPECT_EQ(scan.points[0].intensity, 90.0F);
  EXPECT_EQ(scan.points[1].intensity, 50.0F);
  EXPECT_EQ(scan.points[2].intensity, 50.0F);
  EXPECT_EQ(scan.points[3].intensity, 0.0F);
  EXPECT_EQ(firingsOf(packet, VelodyneModel::VLP_16).size(), 12U);
  EXPECT_NEAR(scan.times_s[0], 110.592e-6, 1e-12);
}

TEST(Hdl32ePacket, TheTimestampIsTheLastLasers) {
  const VelodyneLasers lasers(VelodyneModel::HDL_32E);
  VelodynePacket packet = VelodynePacket::ofHdl32e();
  setAzimuths(packet, 9000, 16);
  packet.setReturn(0, 0, 1000, 3);
  packet.setReturn(11, 31, 1000, 4);
  const ScanPoints scan = pointsOf(packet, lasers);
  ASSERT_EQ(scan.points.size(), 2U);
  expectPoint(scan.points[0], 2.0, 90.0, -30.67);
  EXPECT_EQ(scan.rings[0], 0);
  EXPECT_NEAR(scan.times_s[0], -542.592e-6, 1e-12);
  // 11 steps, and 31 * 1.152 / 46.08 of one more.
  expectPoint(scan.points[1], 2.0, 90.0 + 0.16 * 11 + 0.12, 10.67);
  EXPECT_EQ(scan.rings[1], 31);
  EXPECT_NEAR(scan.times_s[1], 0.0, 1e-12);
}

TEST(Hdl64ePacket, FiringsAreByPairsOfBlocks) {
  VelodynePacket packet = VelodynePacket::ofHdl64e();
  setAzimuths(packet, 100, 17, 2);
  const auto firings = firingsOf(packet, VelodyneModel::HDL_64E);
  ASSERT_EQ(firings.size(), 6U);
  EXPECT_NEAR(firings[0].time_us, -288.0, 1e-9);
  EXPECT_NEAR(firings[5].time_us, -48.0, 1e-9);
  EXPECT_NEAR(firings[5].azimuth, 185.0, 1e-9);
  EXPECT_NEAR(velodyneLaserTime_us(VelodyneModel::HDL_64E, 0, false), 0.0, 1e-9);
  EXPECT_NEAR(velodyneLaserTime_us(VelodyneModel::HDL_64E, 1, false), 1.26, 1e-9);
  EXPECT_NEAR(velodyneLaserTime_us(VelodyneModel::HDL_64E, 36, false), 6.0, 1e-9);
  EXPECT_NEAR(velodyneLaserTime_us(VelodyneModel::HDL_64E, 63, false), 48.0 - 2.34, 1e-9);
  packet.setReturn(3, 5, 1234, 9);
  const VelodyneReturn laser_return = velodyneReturn(packet.data(), firings[1], 37);
  EXPECT_EQ(laser_return.distance, 1234);
  EXPECT_EQ(laser_return.intensity, 9);
}

TEST(Hdl64ePacket, TwoReturnsAreToldByTheAzimuths) {
  VelodynePacket packet = VelodynePacket::ofHdl64e();
  setAzimuths(packet, 100, 20, 4);
  packet.setReturn(5, 5, 1000, 9);
  packet.setReturn(7, 5, 2000, 10);
  const auto firings = firingsOf(packet, VelodyneModel::HDL_64E);
  ASSERT_EQ(firings.size(), 3U);
  EXPECT_NEAR(firings[0].time_us, -3 * 57.6, 1e-9);
  EXPECT_EQ(velodyneReturn(packet.data(), firings[1], 37).distance, 2000);
}

}  // namespace
}  // namespace saw_ndt::internal
