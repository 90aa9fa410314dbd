#include "io/velodyne_turns.h"

#include <gtest/gtest.h>

#include <optional>

#include "io/velodyne_sensor.h"

namespace saw_ndt::internal {
namespace {

constexpr double kEpoch_s = 1.6e9 - 1000.0;  // 600 s past the hour
constexpr std::uint64_t kEpoch_us = 600'000'000;

/// What was found of the scans of a stream.
struct FoundScans {
  std::vector<double> begins_s;
  std::vector<bool> kept;  // of those that ended
};

void add(VelodyneTurns& turns, const VelodynePacket& packet, double host_s, FoundScans& found) {
  for (const TurnFiring& firing : turns.add(packet.data(), host_s)) {
    if (!firing.begins_scan) continue;
    if (!found.begins_s.empty()) found.kept.push_back(firing.ended_a_scan);
    found.begins_s.push_back(firing.time_s);
  }
}

FoundScans turn(VelodyneTurns& turns, const TurningVlp16& sensor, int packets, double epoch_s) {
  FoundScans found;
  for (int i = 0; i < packets; ++i) add(turns, sensor.packet(i), epoch_s + TurningVlp16::time_s(i), found);
  return found;
}

TEST(VelodyneTurns, BeginWhereTheAzimuthPassesZero) {
  VelodyneTurns turns(VelodyneModel::VLP_16);
  const FoundScans found = turn(turns, TurningVlp16(27000.0, kEpoch_us), 300, kEpoch_s);
  ASSERT_EQ(found.begins_s.size(), 5U);
  // A quarter of a turn is no scan.
  EXPECT_EQ(found.kept, (std::vector<bool>{false, true, true, true}));
  for (std::size_t i = 1; i < found.begins_s.size(); ++i) {
    // The first firing behind zero is up to 55 us behind it, and azimuths are whole hundredths of a degree.
    EXPECT_NEAR(found.begins_s[i], kEpoch_s + 0.025 + 0.1 * static_cast<double>(i - 1), 6e-5);
  }
}

TEST(VelodyneTurns, APartialFirstScanOfMoreThanHalfATurnIsKept) {
  VelodyneTurns turns(VelodyneModel::VLP_16);
  EXPECT_TRUE(turn(turns, TurningVlp16(17000.0), 100, 0.0).kept.at(0));
}

TEST(VelodyneTurns, TheEndIsAScanFromHalfATurnOn) {
  VelodyneTurns shorter(VelodyneModel::VLP_16), longer(VelodyneModel::VLP_16);
  turn(shorter, TurningVlp16(), 37, 0.0);
  EXPECT_FALSE(shorter.endsWithScan());
  turn(longer, TurningVlp16(), 38, 0.0);
  EXPECT_TRUE(longer.endsWithScan());
}

TEST(VelodyneTurns, AreFoundWherePacketsAreMissing) {
  VelodyneTurns turns(VelodyneModel::VLP_16);
  const TurningVlp16 sensor(0.0, kEpoch_us);
  FoundScans found;
  for (int i = 0; i < 300; ++i) {
    // Lost: the end of a turn and the begin of the next one, to beyond the azimuth where it broke off or not so far.
    if ((i > 50 && i < 100) || (i > 170 && i < 240)) continue;
    add(turns, sensor.packet(i), kEpoch_s + TurningVlp16::time_s(i), found);
  }
  EXPECT_EQ(found.begins_s.size(), 4U);
  EXPECT_EQ(found.kept, (std::vector<bool>{true, true, true}));
}

TEST(VelodyneTurns, APauseEndsAScan) {
  VelodyneTurns turns(VelodyneModel::VLP_16);
  const TurningVlp16 sensor(0.0, kEpoch_us);
  FoundScans found;
  for (int i = 0; i < 30; ++i) add(turns, sensor.packet(i), kEpoch_s + TurningVlp16::time_s(i), found);
  for (int i = 1050; i < 1100; ++i) add(turns, sensor.packet(i), kEpoch_s + TurningVlp16::time_s(i), found);
  ASSERT_GE(found.begins_s.size(), 2U);
  EXPECT_FALSE(found.kept[0]);
  EXPECT_NEAR(found.begins_s[1], kEpoch_s + TurningVlp16::time_s(1050), 2e-6);
}

TEST(VelodyneTurns, PacketsThatComeInAnotherOrderEndNoScan) {
  VelodyneTurns turns(VelodyneModel::VLP_16);
  const TurningVlp16 sensor(0.0, kEpoch_us);
  FoundScans found;
  for (int i = 0; i < 300; ++i) {
    const int number = i % 10 == 3 ? i + 1 : i % 10 == 4 ? i - 1 : i;
    add(turns, sensor.packet(number), kEpoch_s + TurningVlp16::time_s(i), found);
  }
  EXPECT_EQ(found.begins_s.size(), 4U);
}

TEST(VelodyneTurns, ASensorThatStandsGivesNoScan) {
  VelodyneTurns turns(VelodyneModel::VLP_16);
  VelodynePacket packet = VelodynePacket::ofVlp16();
  for (std::size_t block = 0; block < 12; ++block) packet.setAzimuth(block, 20000);
  FoundScans found;
  for (int i = 0; i < 10000; ++i) {
    packet.setTimestamp(static_cast<std::uint32_t>(i * 1327));
    add(turns, packet, i * 1327e-6, found);
  }
  for (const bool kept : found.kept) EXPECT_FALSE(kept);
  EXPECT_FALSE(turns.endsWithScan());
  EXPECT_GE(found.begins_s.size(), 3U);
}

TEST(VelodyneClock, TakesTheSensorsTimeWhereItIsThatOfGps) {
  VelodyneClock clock;
  for (int i = 0; i < 100; ++i) {
    const double late_s = 0.001 * ((i * 7) % 13);
    EXPECT_EQ(clock.add(kEpoch_s + 0.01 * i + late_s, 600'000'000 + 10'000 * i), i > 0);
    clock.adjust();
    EXPECT_NEAR(clock.time_s(5.0), kEpoch_s + 0.01 * i + 5e-6, 1e-6);
  }
}

TEST(VelodyneClock, GoesOnOverTheFullHour) {
  for (const double ahead_s : {0.0, 1234.0}) {
    VelodyneClock clock;
    for (int i = 0; i < 100; ++i) {
      const double time_s = 3600.0 * 400000 - 0.5 + 0.01 * i;
      const auto us = static_cast<std::uint64_t>(std::llround(1e6 * (time_s + ahead_s)));
      EXPECT_EQ(clock.add(time_s, static_cast<std::uint32_t>(us % 3'600'000'000)), i > 0);
      clock.adjust();
      EXPECT_NEAR(clock.time_s(0.0), time_s, 1e-6);
    }
  }
}

TEST(VelodyneClock, OfASensorWithoutGpsIsSetByTheLeastDelay) {
  VelodyneClock clock;
  for (int i = 0; i < 1000; ++i) {
    const double late_s = i % 10 == 5 ? 0.0 : 0.005;
    clock.add(kEpoch_s + 0.01 * i + late_s, 1'000'000'000 + 10'000 * i);
    clock.adjust();
    if (i < 5) continue;
    EXPECT_NEAR(clock.time_s(0.0), kEpoch_s + 0.01 * i, 1.2e-5);
  }
}

TEST(VelodyneClock, FollowsTheDriftOfASensorWithoutGps) {
  VelodyneClock clock;
  for (int i = 0; i < 100000; ++i) {
    // 50 us a second slow.
    clock.add(kEpoch_s + 0.01 * i,
              static_cast<std::uint32_t>((1'000'000'000 + 10'000 * std::int64_t{i} - i / 2) % 3'600'000'000));
  }
  clock.adjust();
  EXPECT_NEAR(clock.time_s(0.0), kEpoch_s + 999.99, 2e-6);
}

TEST(VelodyneClock, IsThatOfTheHostWhereTheSensorsStands) {
  VelodyneClock clock;
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(clock.add(kEpoch_s + 0.01 * i, 0), i > 0);
    clock.adjust();
    EXPECT_NEAR(clock.time_s(0.0), kEpoch_s + 0.01 * i, 2e-6);
  }
}

TEST(VelodyneClock, BeginsAnewWhereTheSensorsIsSet) {
  VelodyneClock clock;
  clock.add(kEpoch_s, 5'000'000);
  EXPECT_TRUE(clock.add(kEpoch_s + 0.01, 5'010'000));
  EXPECT_FALSE(clock.add(kEpoch_s + 0.02, 200'020'000));
  clock.adjust();
  EXPECT_NEAR(clock.time_s(0.0), kEpoch_s + 0.02, 1e-6);
}

TEST(VelodyneClock, FollowsAHostThatIsSet) {
  VelodyneClock clock;
  for (int i = 0; i < 1000; ++i) {
    clock.add(kEpoch_s + 0.01 * i + (i < 500 ? 0.0 : 10.0), 600'000'000 + 10'000 * i);
  }
  clock.adjust();
  EXPECT_NEAR(clock.time_s(0.0), kEpoch_s + 19.99, 1e-3);
}

}  // namespace
}  // namespace saw_ndt::internal
