#include "drives/velodyne_capture.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "expect_throws.h"
#include "io/velodyne_sensor.h"
#include "recordings/capture_writer.h"
#include "saw_ndt/common/error.h"
#include "temporary_folder.h"

namespace saw_ndt::internal {
namespace {

constexpr double kBegin_s = 1.6e9;
constexpr std::uint64_t kBegin_us = 1'600'000'000;  // past the hour
using Format = CaptureWriter::Format;

std::string payloadOf(const VelodynePacket& packet) {
  return {reinterpret_cast<const char*>(packet.data()), VelodynePacket::size()};
}

class VelodyneCapture : public ::testing::Test {
 protected:
  using Framing = std::function<std::string(const std::string& ip_packet)>;

  static std::string asEthernet(const std::string& ip_packet) { return ethernetFrame(ip_packet); }

  static void addTurns(CaptureWriter& writer, const TurningVlp16& sensor, int packets, int address = 201,
                       const Framing& framing = asEthernet) {
    for (int i = 0; i < packets; ++i) {
      writer.add(framing(ipPacket(payloadOf(sensor.packet(i)), address)), kBegin_s + TurningVlp16::time_s(i));
    }
  }

  std::filesystem::path write(const CaptureWriter& writer) const {
    const std::filesystem::path path = folder.path() / "drive.pcap";
    writer.write(path);
    return path;
  }

  void expectRefused(const CaptureWriter& writer, std::initializer_list<std::string> parts,
                     const RecordingOptions& options = {}) const {
    const auto path = write(writer);
    expectThrows<Error>([&] { openVelodyneCapture(path, options); }, parts);
  }

  TemporaryFolder folder;
};

TEST_F(VelodyneCapture, HasAScanATurn) {
  CaptureWriter writer;
  addTurns(writer, TurningVlp16(0.0, kBegin_us), 300);  // 3.98 turns
  const auto capture = openVelodyneCapture(write(writer));
  EXPECT_EQ(capture->name(), "drive");
  EXPECT_TRUE(capture->hasStamps());
  EXPECT_FALSE(capture->hasPoses());
  ASSERT_EQ(capture->scanCount(), 4);
  EXPECT_EQ(capture->scanName(3), "000003");
  ScanPoints scan;
  for (int number = 0; number < 4; ++number) {
    const double stamp_s = capture->stamps()[static_cast<std::size_t>(number)];
    EXPECT_NEAR(stamp_s, kBegin_s + 0.1 * number, 6e-5);
    capture->readScan(number, scan);
    // 1808.4 firings a turn.
    if (number < 3) {
      EXPECT_NEAR(static_cast<double>(scan.points.size()), 16 * 1808.4, 16.0);
    }
    ASSERT_EQ(scan.rings.size(), scan.points.size());
    ASSERT_EQ(scan.times_s.size(), scan.points.size());
    EXPECT_EQ(std::set<std::uint16_t>(scan.rings.begin(), scan.rings.end()).size(), 16U);
    EXPECT_EQ(scan.times_s.front(), stamp_s);
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      const LidarPoint& point = scan.points[i];
      ASSERT_NEAR(std::hypot(std::hypot(point.x, point.y), point.z), 10.0, 1e-5);
      // A turn in 0.1 s, clockwise from x. Azimuths are rounded to 0.01 degrees in the packet and once more behind it.
      const double azimuth = std::atan2(-point.y, point.x) / (2.0 * M_PI);
      const double turns = (scan.times_s[i] - kBegin_s) / 0.1;
      ASSERT_NEAR(std::remainder(azimuth - turns, 1.0), 0.0, 6e-5);
      ASSERT_GE(turns, number - 1e-3);
      ASSERT_LE(turns, number + 1.001);
    }
  }
}

TEST_F(VelodyneCapture, ScansAreReadInAnyOrder) {
  CaptureWriter writer;
  addTurns(writer, TurningVlp16(12000.0, kBegin_us), 400);
  const auto capture = openVelodyneCapture(write(writer));
  std::vector<ScanPoints> scans(static_cast<std::size_t>(capture->scanCount()));
  for (int i = 0; i < capture->scanCount(); ++i) capture->readScan(i, scans[static_cast<std::size_t>(i)]);
  ScanPoints again;
  for (const int i : {3, 0, 2, 2, 4, 1}) {
    capture->readScan(i, again);
    EXPECT_EQ(again.times_s, scans.at(static_cast<std::size_t>(i)).times_s);
    EXPECT_EQ(again.rings, scans[static_cast<std::size_t>(i)].rings);
  }
  EXPECT_THROW(capture->readScan(capture->scanCount(), again), std::out_of_range);
  EXPECT_THROW(capture->readScan(-1, again), std::out_of_range);
}

TEST_F(VelodyneCapture, ShortPartsAtBothEndsAreLeftOut) {
  CaptureWriter writer;
  addTurns(writer, TurningVlp16(30000.0, kBegin_us), 12 + 75 + 30);
  const auto capture = openVelodyneCapture(write(writer));
  ASSERT_EQ(capture->scanCount(), 1);
  EXPECT_NEAR(capture->stamps()[0], kBegin_s + 0.1 / 6.0, 6e-5);
}

TEST_F(VelodyneCapture, IsReadInEveryFormatAndFromEveryLink) {
  const TurningVlp16 sensor(0.0, kBegin_us);
  struct Case {
    std::uint32_t link_type;
    Format format;
    std::string before;  // the IP packet
  };
  const std::string addresses(12, '\x11');
  const std::string ip("\x08\x00", 2);
  const std::string vlan("\x81\x00\x00\x05", 4), outer_vlan("\x88\xA8\x00\x07", 4);
  const Case cases[] = {{1, Format::PCAP, addresses + ip},
                        {1, Format::PCAP_NANOSECONDS, addresses + ip},
                        {1, Format::PCAPNG, addresses + ip},
                        {1, Format::PCAP, addresses + vlan + ip},
                        {1, Format::PCAP, addresses + outer_vlan + vlan + ip},
                        {113, Format::PCAP, std::string(14, '\x01') + ip},
                        {276, Format::PCAP, ip + std::string(18, '\x01')},
                        {101, Format::PCAP, ""},
                        {228, Format::PCAPNG, ""},
                        {0, Format::PCAP, std::string("\x02\x00\x00\x00", 4)},
                        {108, Format::PCAP, std::string("\x00\x00\x00\x02", 4)}};
  ScanPoints first, scan;
  for (const Case& one : cases) {
    SCOPED_TRACE(one.link_type);
    CaptureWriter writer(one.link_type, one.format);
    addTurns(writer, sensor, 200, 201, [&](const std::string& packet) { return one.before + packet; });
    const auto path = write(writer);
    EXPECT_TRUE(isCapture(path));
    const auto capture = openVelodyneCapture(path);
    ASSERT_EQ(capture->scanCount(), 3);
    capture->readScan(1, scan);
    if (first.times_s.empty()) first = scan;
    EXPECT_EQ(scan.times_s, first.times_s);
  }
}

TEST_F(VelodyneCapture, WithCutFramesIsReadToWhereItEnds) {
  CaptureWriter writer;
  addTurns(writer, TurningVlp16(0.0, kBegin_us), 200);
  ScanPoints scan;
  for (std::size_t size = 0; size <= writer.content().size(); size += size < 5000 ? 97 : 17777) {
    const auto path = folder.write("cut.pcap", writer.content().substr(0, size));
    try {
      const auto capture = openVelodyneCapture(path);
      EXPECT_LE(capture->scanCount(), 3);
      for (int i = 0; i < capture->scanCount(); ++i) capture->readScan(i, scan);
    } catch (const Error& error) {
      EXPECT_LT(size, 38U * 1300) << error.what();
    }
  }
}

TEST_F(VelodyneCapture, DamagedOnesDoNoHarm) {
  CaptureWriter writer;
  addTurns(writer, TurningVlp16(0.0, kBegin_us), 100);
  std::uint32_t random = 1;
  ScanPoints scan;
  for (int trial = 0; trial < 300; ++trial) {
    std::string content = writer.content();
    for (int i = 0; i < 40; ++i) {
      random = random * 1664525U + 1013904223U;
      // Mostly headers: those of the file, and of frames, which are 1264 bytes from each other.
      const std::size_t place = i % 8 == 0 ? random % 64U : 24 + 1264 * (random % 100U) + (random >> 8) % 80U;
      content[place % content.size()] = static_cast<char>(random >> 16);
    }
    const auto path = folder.write("damaged.pcap", content);
    try {
      const auto capture = openVelodyneCapture(path);
      for (int i = 0; i < capture->scanCount(); ++i) capture->readScan(i, scan);
    } catch (const Error&) {
    }
  }
}

TEST_F(VelodyneCapture, OtherPacketsArePassedOver) {
  CaptureWriter alone, among;
  const TurningVlp16 sensor(0.0, kBegin_us);
  addTurns(alone, sensor, 100);
  VelodynePacket other_identifier = sensor.packet(3);
  other_identifier.setIdentifier(7, 0xAABB);
  for (int i = 0; i < 100; ++i) {
    const double time_s = kBegin_s + TurningVlp16::time_s(i);
    among.add(ethernetFrame(ipPacket(std::string(512, '\x42'))), time_s);  // as a position packet
    among.add(ethernetFrame(ipPacket(payloadOf(other_identifier))), time_s);
    among.add(ethernetFrame(std::string(1230, '\x60'), std::string("\x86\xDD", 2)), time_s);  // IPv6
    among.add(ethernetFrame(ipPacket(payloadOf(sensor.packet(3)), 201, 0x2000)), time_s);
    among.add("short", time_s);
    among.add(ethernetFrame(ipPacket(payloadOf(sensor.packet(i)))), time_s);
  }
  ScanPoints scan_alone, scan_among;
  openVelodyneCapture(write(alone))->readScan(0, scan_alone);
  const auto capture = openVelodyneCapture(write(among));
  ASSERT_EQ(capture->scanCount(), 1);
  capture->readScan(0, scan_among);
  EXPECT_EQ(scan_alone.times_s, scan_among.times_s);
}

TEST_F(VelodyneCapture, OfSeveralSensorsIsReadByAddressOrTheMostPackets) {
  CaptureWriter writer;
  const TurningVlp16 first(0.0, kBegin_us), second(9000.0, kBegin_us);
  for (int i = 0; i < 160; ++i) {
    const double time_s = kBegin_s + TurningVlp16::time_s(i);
    if (i < 100) writer.add(ethernetFrame(ipPacket(payloadOf(first.packet(i)), 201)), time_s);
    writer.add(ethernetFrame(ipPacket(payloadOf(second.packet(i)), 202)), time_s);
  }
  const auto path = write(writer);
  EXPECT_NEAR(openVelodyneCapture(path)->stamps().at(1), kBegin_s + 0.075, 6e-5);
  RecordingOptions options;
  options.topic = "192.168.1.201";
  const auto capture = openVelodyneCapture(path, options);
  ASSERT_EQ(capture->scanCount(), 1);
  EXPECT_NEAR(capture->stamps()[0], kBegin_s, 6e-5);
  ScanPoints scan;
  capture->readScan(0, scan);
  EXPECT_NEAR(static_cast<double>(scan.points.size()), 16 * 1808.4, 16.0);
  options.topic = "10.0.0.1";
  expectThrows<Error>([&] { openVelodyneCapture(path, options); }, {"10.0.0.1", "192.168.1.201, 192.168.1.202"});
}

TEST_F(VelodyneCapture, OfASensorThatIsNotReadIsRefusedByItsProduct) {
  const VelodynePacket vlp_32c(0x37, 0x28);
  CaptureWriter writer;
  for (int i = 0; i < 5; ++i) writer.add(ethernetFrame(ipPacket(payloadOf(vlp_32c))), kBegin_s);
  expectRefused(writer, {"drive.pcap", "192.168.1.201", "0x28 (VLP-32C)", "VLP-16", "HDL-64E"});
}

TEST_F(VelodyneCapture, OfAnHdl64eIsRefusedWithoutCalibration) {
  CaptureWriter writer;
  writer.add(ethernetFrame(ipPacket(payloadOf(VelodynePacket::ofHdl64e()))), kBegin_s);
  expectRefused(writer, {"drive.pcap", "HDL-64E", "calibration"});
}

TEST_F(VelodyneCapture, WithoutAScanIsRefused) {
  expectRefused(CaptureWriter(), {"drive.pcap", "none of the 0 packets"});
  CaptureWriter fragments;
  fragments.add(ethernetFrame(ipPacket("part", 201, 0x2000)), kBegin_s);
  expectRefused(fragments, {"none of the 1 packets", "1 are fragments"});
  CaptureWriter short_one;
  addTurns(short_one, TurningVlp16(), 30);
  expectRefused(short_one, {"drive.pcap", "30 data packets are no half turn"});
  CaptureWriter other_link(147);
  expectRefused(other_link, {"drive.pcap", "link type 147"});
  expectThrows<Error>([&] { openVelodyneCapture(folder.path() / "none.pcap"); }, {"none.pcap"});
  expectThrows<Error>([&] { openVelodyneCapture(folder.path()); }, {"directory"});
  const auto text = folder.write("text.pcap", "This is a text and no capture of packets at all.");
  EXPECT_FALSE(isCapture(text));
  expectThrows<Error>([&] { openVelodyneCapture(text); }, {"text.pcap"});
}

TEST_F(VelodyneCapture, ThatIsCutBehindItsOpeningIsAnError) {
  CaptureWriter writer;
  addTurns(writer, TurningVlp16(0.0, kBegin_us), 300);
  const auto path = write(writer);
  const auto capture = openVelodyneCapture(path);
  std::filesystem::resize_file(path, 200000);
  ScanPoints scan;
  expectThrows<Error>([&] { capture->readScan(3, scan); }, {"drive.pcap", "scan 000003"});
  capture->readScan(0, scan);
}

TEST(IsCapture, IsToldByTheFirstBytes) {
  const TemporaryFolder folder;
  EXPECT_TRUE(isCapture(folder.write("a", std::string("\xA1\xB2\xC3\xD4", 4))));
  EXPECT_FALSE(isCapture(folder.write("b", std::string("\xA1\xB2\xC3", 3))));
  EXPECT_FALSE(isCapture(folder.path() / "none"));
  EXPECT_FALSE(isCapture(folder.path()));
}

}  // namespace
}  // namespace saw_ndt::internal
