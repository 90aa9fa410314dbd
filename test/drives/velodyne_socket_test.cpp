#include "drives/velodyne_socket.h"

#include <gtest/gtest.h>

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <chrono>
#include <future>
#include <thread>

#include "expect_throws.h"
#include "io/velodyne_sensor.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr char kHere[] = "127.0.0.1";

/// A sender of packets to a port of this machine which nothing listened to.
class Sender {
 public:
  Sender() : socket_(context_, udp::v4()) {
    udp::socket any_free(context_, udp::endpoint(asio::ip::make_address(kHere), 0));
    target_ = any_free.local_endpoint();
  }
  explicit Sender(std::uint16_t port) : socket_(context_, udp::v4()), target_(asio::ip::make_address(kHere), port) {}

  std::uint16_t port() const { return target_.port(); }
  void send(const void* bytes, std::size_t size) { socket_.send_to(asio::buffer(bytes, size), target_); }
  void send(const VelodynePacket& packet) { send(packet.data(), VelodynePacket::size()); }
  /// Slower than they can be received.
  void send(const TurningVlp16& sensor, int first, int end) {
    for (int i = first; i < end; ++i) {
      send(sensor.packet(i));
      if (i % 2 == 1) std::this_thread::sleep_for(milliseconds(1));
    }
  }

 private:
  asio::io_context context_;
  udp::socket socket_;
  udp::endpoint target_;
};

/// Waits until something holds; false after ten seconds.
template <typename Condition>
bool waitFor(const Condition& condition) {
  const Clock::time_point end = Clock::now() + std::chrono::seconds(10);
  while (!condition()) {
    if (Clock::now() > end) return false;
    std::this_thread::sleep_for(milliseconds(1));
  }
  return true;
}

TEST(VelodyneSocket, GivesScansAsTheyAreMeasured) {
  Sender sender;
  const auto source = listenToVelodyne(kHere, sender.port());
  EXPECT_EQ(source->scanCount(), std::nullopt);
  const TurningVlp16 sensor;
  // Two and a half seconds in real time.
  const auto measuring = std::async(std::launch::async, [&] {
    const Clock::time_point begin = Clock::now();
    for (int i = 0; i < 1900; ++i) {
      std::this_thread::sleep_until(begin + std::chrono::microseconds(std::llround(1e6 * TurningVlp16::time_s(i))));
      sender.send(sensor.packet(i));
    }
  });
  const double begin_s = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  RecordedScan scan;
  for (int number = 0; number < 25; ++number) {
    ASSERT_TRUE(source->next(scan));
    EXPECT_EQ(scan.number, number);
    EXPECT_EQ(scan.name, "scan " + std::to_string(number));
    EXPECT_NEAR(static_cast<double>(scan.points.size()), 16 * 1808.4, 17.0);
    ASSERT_EQ(scan.rings.size(), scan.points.size());
    ASSERT_EQ(scan.times_s.size(), scan.points.size());
    EXPECT_EQ(scan.times_s.front(), scan.stamp_s);
    EXPECT_NEAR(scan.times_s.back() - scan.stamp_s, 0.1, 1e-4);
    EXPECT_NEAR(scan.stamp_s, begin_s + 0.1 * number, 0.08);
    EXPECT_EQ(scan.points[1000].intensity, static_cast<float>(number));
    EXPECT_EQ(scan.points.back().intensity, static_cast<float>(number));
  }
  measuring.wait();
  EXPECT_EQ(source->leftOut(), 0U);
  EXPECT_EQ(source->rejected(), 0U);
}

TEST(VelodyneSocket, ALateReaderGetsTheNewestScan) {
  Sender sender;
  const auto source = listenToVelodyne(kHere, sender.port());
  sender.send(TurningVlp16(), 0, 76 * 10);
  ASSERT_TRUE(waitFor([&] { return source->leftOut() == 9; }));
  RecordedScan scan;
  ASSERT_TRUE(source->next(scan));
  EXPECT_EQ(scan.number, 9);
  EXPECT_EQ(scan.points.back().intensity, 9.0F);
  EXPECT_EQ(source->leftOut(), 9U);
  sender.send(TurningVlp16(), 76 * 10, 76 * 11);
  ASSERT_TRUE(source->next(scan));
  EXPECT_EQ(scan.number, 10);
}

TEST(VelodyneSocket, RubbishIsCountedAndEndsNoScan) {
  Sender sender;
  const auto source = listenToVelodyne(kHere, sender.port());
  const TurningVlp16 sensor;
  Sender other_sensor(sender.port());
  const VelodynePacket vlp_32c(0x37, 0x28);
  const std::string rubbish(2000, '\x55');
  std::size_t sent = 0;
  for (int i = 0; i < 80; ++i) {
    sender.send(sensor.packet(i));
    sender.send(rubbish.data(), rubbish.size());
    sender.send(rubbish.data(), static_cast<std::size_t>(i) * 15);
    sender.send(rubbish.data(), kVelodynePacketBytes);
    sender.send(vlp_32c);
    sender.send(VelodynePacket::ofHdl64e());
    other_sensor.send(TurningVlp16(7000.0).packet(i));
    sent += 6;
    ASSERT_TRUE(waitFor([&] { return source->rejected() == sent; })) << source->rejected();
  }
  RecordedScan scan;
  ASSERT_TRUE(source->next(scan));
  EXPECT_NEAR(static_cast<double>(scan.points.size()), 16 * 1808.4, 17.0);
  EXPECT_EQ(source->rejected(), sent);
}

TEST(VelodyneSocket, AFloodOfRubbishDoesNotKeepItFromStopping) {
  Sender sender;
  const auto source = listenToVelodyne(kHere, sender.port());
  std::atomic<bool> ended{false};
  std::thread flood([&] {
    const std::string rubbish(kVelodynePacketBytes, '\x55');
    while (!ended) sender.send(rubbish.data(), rubbish.size());
  });
  EXPECT_TRUE(waitFor([&] { return source->rejected() > 10000; }));
  const Clock::time_point begin = Clock::now();
  source->stop();
  RecordedScan scan;
  EXPECT_FALSE(source->next(scan));
  EXPECT_LT(Clock::now() - begin, milliseconds(500));
  ended = true;
  flood.join();
}

TEST(VelodyneSocket, StopEndsAReaderThatWaits) {
  for (int trial = 0; trial < 20; ++trial) {
    Sender sender;
    const auto source = listenToVelodyne(kHere, sender.port());
    const auto stopping = std::async(std::launch::async, [&] {
      std::this_thread::sleep_for(milliseconds(trial));
      source->stop();
      source->stop();
    });
    RecordedScan scan;
    scan.number = -7;
    EXPECT_FALSE(source->next(scan));
    EXPECT_FALSE(source->next(scan));
    EXPECT_EQ(scan.number, -7);
    stopping.wait();
  }
}

TEST(VelodyneSocket, AfterStopNoScanIsGiven) {
  Sender sender;
  const auto source = listenToVelodyne(kHere, sender.port());
  sender.send(TurningVlp16(), 0, 76 * 3);
  ASSERT_TRUE(waitFor([&] { return source->leftOut() == 2; }));
  source->stop();
  RecordedScan scan;
  EXPECT_FALSE(source->next(scan));
}

TEST(VelodyneSocket, AnotherSensorIsTakenWhereTheFirstIsSilent) {
  Sender sender;
  const auto source = listenToVelodyne(kHere, sender.port());
  sender.send(TurningVlp16(), 0, 30);
  std::this_thread::sleep_for(milliseconds(1200));
  Sender other_sensor(sender.port());
  other_sensor.send(TurningVlp16(), 0, 76);
  RecordedScan scan;
  ASSERT_TRUE(source->next(scan));
  EXPECT_NEAR(static_cast<double>(scan.points.size()), 16 * 1808.4, 17.0);
  EXPECT_EQ(source->rejected(), 0U);
}

TEST(VelodyneSocket, APortInUseIsNamed) {
  Sender sender;
  const auto source = listenToVelodyne(kHere, sender.port());
  expectThrows<Error>([&] { listenToVelodyne(kHere, sender.port()); },
                      {"udp:127.0.0.1:" + std::to_string(sender.port()), "in use"});
}

TEST(VelodyneSocket, AnAddressOfNoInterfaceIsNamed) {
  expectThrows<Error>([] { listenToVelodyne("192.0.2.1", 23680); }, {"udp:192.0.2.1:23680"});
  expectThrows<Error>([] { listenToVelodyne("lidar", 23680); }, {"udp:lidar:23680"});
}

TEST(VelodyneSocket, ACalibrationThatCannotBeReadIsAnError) {
  Sender sender;
  expectThrows<Error>([&] { listenToVelodyne(kHere, sender.port(), "none.xml"); }, {"none.xml"});
}

}  // namespace
}  // namespace saw_ndt::internal
