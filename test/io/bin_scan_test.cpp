#include "io/bin_scan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <random>

#include "expect_throws.h"
#include "real_data.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/drives/kitti_sequence.h"
#include "saw_ndt/io/kitti.h"
#include "saw_ndt/io/scan_file.h"
#include "temporary_folder.h"

namespace saw_ndt {

using namespace internal;

namespace {

constexpr int kRings = 16, kColumns = 600;
constexpr float kScanTime_s = 0.1F;

enum class Order { RINGS, COLUMNS };

/// x y z intensity ring time of a spinning LiDAR in a yard whose walls are 8 to 12 m away.
std::vector<std::vector<float>> rows(Order order) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> reflectance(0.0F, 1.0F);
  std::vector<std::vector<float>> points;
  for (int i = 0; i < kRings * kColumns; ++i) {
    const int ring = order == Order::RINGS ? i / kColumns : i % kRings;
    const int column = order == Order::RINGS ? i % kColumns : i / kRings;
    const double azimuth = 2.0 * kPi * column / kColumns, elevation = radiansFromDegrees(2.0 * ring - 15.0);
    const double wall_m = 10.0 + 2.0 * std::sin(5.0 * azimuth);
    const double range_m = elevation < 0.0 ? std::min(wall_m, -1.7 / std::sin(elevation)) : wall_m;
    points.push_back({static_cast<float>(range_m * std::cos(elevation) * std::cos(azimuth)),
                      static_cast<float>(range_m * std::cos(elevation) * std::sin(azimuth)),
                      static_cast<float>(range_m * std::sin(elevation)), reflectance(random), static_cast<float>(ring),
                      kScanTime_s * static_cast<float>(column) / kColumns});
  }
  return points;
}

/// Some of the columns of points.
std::vector<float> columnsOf(const std::vector<std::vector<float>>& points, const std::vector<std::size_t>& columns) {
  std::vector<float> values;
  for (const std::vector<float>& point : points) {
    for (const std::size_t column : columns) values.push_back(point[column]);
  }
  return values;
}

std::string bytesOf(const std::vector<float>& values) {
  std::string bytes(values.size() * sizeof(float), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

class BinScan : public ::testing::TestWithParam<Order> {
 protected:
  std::filesystem::path write(const std::vector<std::size_t>& columns) const {
    return folder.write("a.bin", bytesOf(columnsOf(points, columns)));
  }

  const std::vector<std::vector<float>> points = rows(GetParam());
  TemporaryFolder folder;
};

TEST_P(BinScan, FieldsAreToldFromTheValues) {
  const std::vector<std::size_t> layouts[] = {
      {0, 1, 2, 3}, {0, 1, 2, 3, 4}, {0, 1, 2, 3, 5}, {0, 1, 2, 3, 4, 5}, {0, 1, 2, 3, 5, 4}};
  for (const std::vector<std::size_t>& columns : layouts) {
    SCOPED_TRACE(columns.size() + 10 * columns.back());
    const bool has_ring = std::count(columns.begin(), columns.end(), 4) > 0;
    const bool has_time = std::count(columns.begin(), columns.end(), 5) > 0;
    for (const int stated : {0, static_cast<int>(columns.size())}) {
      const ScanPoints scan = readScanPoints(write(columns), stated);
      ASSERT_EQ(scan.points.size(), points.size());
      EXPECT_EQ(scan.rings.size(), has_ring ? points.size() : 0);
      EXPECT_EQ(scan.times_s.size(), has_time ? points.size() : 0);
      for (const std::size_t i : {std::size_t{0}, std::size_t{4711}, points.size() - 1}) {
        EXPECT_EQ(scan.points[i].x, points[i][0]);
        EXPECT_EQ(scan.points[i].intensity, points[i][3]);
        EXPECT_EQ(has_ring ? static_cast<float>(scan.rings[i]) : points[i][4], points[i][4]);
        EXPECT_EQ(has_time ? static_cast<float>(scan.times_s[i]) : points[i][5], points[i][5]);
      }
    }
  }
}

TEST_P(BinScan, OtherNumbersOfFieldsAreRefused) {
  for (const std::vector<std::size_t>& columns : {std::vector<std::size_t>{0, 1, 2}, {0, 1, 2, 4, 3, 5, 3, 3}}) {
    const std::string said = "seems to have " + std::to_string(columns.size()) + " float32 a point";
    expectThrows<Error>([&] { readScanPoints(write(columns)); }, {"a.bin", said});
  }
  expectThrows<Error>([&] { readKittiScan(write({0, 1, 2, 3, 4})); }, {"a.bin", "seems to have 5", "4 are needed"});
  expectThrows<std::invalid_argument>([&] { readScanPoints(write({0, 1, 2, 3}), 3); }, {"bin_fields = 3"});
}

TEST_P(BinScan, CutOnesAreNamedWhateverTheirSize) {
  const std::string whole = bytesOf(columnsOf(points, {0, 1, 2, 3, 4}));
  expectThrows<Error>([&] { readScanPoints(folder.write("a.bin", whole.substr(0, 20 * 900 + 4))); },
                      {"a.bin: offset 18000", "no multiple of 20"});
  // A scan of four floats whose cut size is one of five.
  const std::string kitti = bytesOf(columnsOf(points, {0, 1, 2, 3}));
  expectThrows<Error>([&] { readScanPoints(folder.write("a.bin", kitti.substr(0, 20 * 901))); },
                      {"a.bin: offset 18016", "no multiple of 16"});
  EXPECT_EQ(readScanPoints(folder.write("a.bin", kitti.substr(0, 16 * 5))).points.size(), 5U);  // too few to say
}

// Drivers write zeros or NaN where a beam met nothing; a few points may be anything.
TEST_P(BinScan, NoReturnsAndAFewWildPointsDoNotMatter) {
  std::vector<float> values = columnsOf(points, {0, 1, 2, 3, 4});
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float no_return = i % 2 == 0 ? 0.0F : std::numeric_limits<float>::quiet_NaN();
    if (i % 3 == 0) std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(5 * i), 3, no_return);
    if (i % 97 == 0) values[5 * i] = 1e38F;
    if (i % 89 == 0) values[5 * i] = std::numeric_limits<float>::infinity();
  }
  const ScanPoints scan = readScanPoints(folder.write("a.bin", bytesOf(values)));
  EXPECT_EQ(scan.points.size(), points.size());
  EXPECT_EQ(scan.rings.size(), points.size());
}

TEST_P(BinScan, CoordinatesThatNoScanHasAreRefused) {
  // The same scan in 16-bit steps of 5 mm, four numbers a point.
  std::string shorts;
  for (const std::vector<float>& point : points) {
    for (const std::size_t column : {0U, 1U, 2U, 3U}) {
      const auto value = static_cast<std::uint16_t>((point[column] + 100.0F) / 0.005F);
      shorts.append(reinterpret_cast<const char*>(&value), sizeof(value));
    }
  }
  const auto path = folder.write("a.bin", shorts);
  for (const int stated : {0, 4, 5, 6}) {
    expectThrows<Error>([&] { readScanPoints(path, stated); }, {"a.bin", "256 points looked at", "no scan has"});
  }
  expectThrows<Error>([&] { readKittiScan(path); }, {"a.bin", "of 256 points looked at"});
}

TEST_P(BinScan, ASequenceTellsItsFieldsOnce) {
  folder.write("velodyne/000000.bin", "");
  folder.write("velodyne/000001.bin", bytesOf({1, 2, 3, 0.5F, 1}));
  folder.write("velodyne/000002.bin", bytesOf(columnsOf(points, {0, 1, 2, 3, 4})));
  folder.write("labels/000002.label", std::string(4 * points.size(), '\0'));
  for (const int stated : {0, 5}) {
    const KittiSequence sequence(folder.path(), {}, stated);
    const auto source = sequence.scans({2, 0, 1});
    RecordedScan scan;
    ASSERT_TRUE(source->next(scan));
    EXPECT_EQ(scan.failure, "");
    ASSERT_EQ(scan.rings.size(), points.size());
    EXPECT_EQ(static_cast<float>(scan.rings[77]), points[77][4]);
    ASSERT_TRUE(source->next(scan));
    EXPECT_NE(scan.failure.find("the file is empty"), std::string::npos);
    EXPECT_TRUE(scan.points.empty() && scan.rings.empty());
    ASSERT_TRUE(source->next(scan));
    EXPECT_EQ(scan.points.size(), 1U);
    EXPECT_EQ(sequence.readLabels(2).size(), points.size());
    EXPECT_EQ(sequence.readScan(2).size(), points.size());
  }
  expectThrows<Error>([&] { KittiSequence(folder.path(), {}, 4).readScan(1); }, {"000001.bin", "multiple of 16"});
  expectThrows<std::invalid_argument>([&] { KittiSequence(folder.path(), {}, 7); }, {"bin_fields = 7"});
}

INSTANTIATE_TEST_SUITE_P(Orders, BinScan, ::testing::Values(Order::RINGS, Order::COLUMNS),
                         [](const auto& order) { return order.param == Order::RINGS ? "Rings" : "Columns"; });

TEST(RealBinScans, OfKittiHaveFourFieldsAndFiveWithARing) {
  const std::filesystem::path data = realDataFolder();
  if (data.empty()) GTEST_SKIP() << "no real scans: set SAW_NDT_DATA to their folder";
  const TemporaryFolder folder;
  std::size_t scans = 0;
  for (const std::string drive : {"00", "01", "03", "drive_0005"}) {
    const KittiSequence sequence(data / "kitti" / "sequences" / drive);
    for (int number = 0; number < sequence.scanCount(); ++number, ++scans) {
      SCOPED_TRACE(sequence.scanPath(number));
      ASSERT_EQ(tellBinFields(sequence.scanPath(number)), std::optional<int>(4));
      if (number % 10 != 0) continue;
      const std::vector<LidarPoint> points = sequence.readScan(number);
      std::vector<float> values;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const LidarPoint& p = points[i];
        values.insert(values.end(), {p.x, p.y, p.z, p.intensity, static_cast<float>(i % 64)});
      }
      const ScanPoints scan = readScanPoints(folder.write("a.bin", bytesOf(values)));
      ASSERT_EQ(scan.points.size(), points.size());
      EXPECT_EQ(scan.rings.size(), points.size());
    }
  }
  EXPECT_EQ(scans, 100U);
}

}  // namespace
}  // namespace saw_ndt
