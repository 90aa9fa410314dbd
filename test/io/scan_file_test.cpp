#include "saw_ndt/io/scan_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "expect_throws.h"
#include "io/pcd_cloud.h"
#include "pcd_text.h"
#include "saw_ndt/common/error.h"
#include "temporary_folder.h"

namespace saw_ndt {

using namespace internal;

namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN();

const std::vector<double> kX = {1.5, -2.0, 0.0, 4.0}, kY = {5.0, 6.25, 0.0, -8.0}, kZ = {-1.0, 0.5, 0.0, 2.0};
const std::vector<double> kRing = {3, 0, 3, 1};

TestField x() { return {"x", 'F', 4, 1, kX}; }
TestField y() { return {"y", 'F', 4, 1, kY}; }
TestField z() { return {"z", 'F', 4, 1, kZ}; }

class PcdScan : public ::testing::Test {
 protected:
  ScanPoints read(const std::vector<TestField>& fields, const std::string& data = "binary") const {
    return readScanPoints(folder.write("a.pcd", pcdText(fields, data)));
  }
  std::vector<double> times(char type, int size, const std::vector<double>& values) const {
    return read({x(), y(), z(), {"t", type, size, 1, values}}).times_s;
  }

  TemporaryFolder folder;
};

void expectThePoints(const ScanPoints& scan) {
  ASSERT_EQ(scan.points.size(), kX.size());
  for (std::size_t i = 0; i < kX.size(); ++i) {
    EXPECT_EQ(static_cast<double>(scan.points[i].x), kX[i]);
    EXPECT_EQ(static_cast<double>(scan.points[i].y), kY[i]);
    EXPECT_EQ(static_cast<double>(scan.points[i].z), kZ[i]);
  }
}

TEST_F(PcdScan, FieldsAreOfAnyOrderAndNumberType) {
  const std::vector<double> other = {9, 9, 9, 9};
  const std::vector<TestField> layouts[] = {
      {{"ring", 'U', 2, 1, kRing},
       {"_", 'U', 1, 3, other},
       z(),
       {"t", 'U', 4, 1, {0, 5e7, 6e7, 1e8}},
       {"intensity", 'U', 1, 1, {7, 8, 0, 255}},
       y(),
       {"_", 'F', 8, 2, other},
       x(),
       {"x", 'F', 8, 1, other}},
      {{"x", 'F', 8, 1, kX},
       {"y", 'F', 8, 1, kY},
       {"z", 'F', 8, 1, kZ},
       {"normal_x", 'F', 4, 2, other},
       {"i", 'F', 8, 2, {7, 8, 0, 255}},
       {"channel", 'F', 4, 1, kRing},
       {"timestamp", 'F', 8, 1, {0, 0.05, 0.06, 0.1}}},
      {{"line", 'I', 8, 1, kRing},
       {"Intensity", 'I', 2, 1, {7, 8, 0, 255}},
       x(),
       y(),
       z(),
       {"offset_time", 'U', 8, 1, {0, 5e4, 6e4, 1e5}}},
  };
  for (const std::vector<TestField>& fields : layouts) {
    for (const std::string data : {"binary", "ascii", "compressed"}) {
      SCOPED_TRACE(fields.front().name + ' ' + data);
      const bool compressed = data == "compressed";
      auto path = folder.write("a.pcd", pcdText(fields, compressed ? "binary" : data));
      if (compressed) {
        writePcdCloud(folder.path() / "b.pcd", readPcdCloud(path));
        path = folder.path() / "b.pcd";
      }
      const ScanPoints scan = readScanPoints(path);
      expectThePoints(scan);
      EXPECT_EQ(scan.points[0].intensity, 7.0F);
      EXPECT_EQ(scan.points[3].intensity, 255.0F);
      EXPECT_EQ(scan.rings, std::vector<std::uint16_t>(kRing.begin(), kRing.end()));
      ASSERT_EQ(scan.times_s.size(), 4U);
      EXPECT_NEAR(scan.times_s[1], 0.05, 1e-9);
      EXPECT_NEAR(scan.times_s[3], 0.1, 1e-9);
      EXPECT_EQ(scan.height, 1U);
    }
  }
}

TEST_F(PcdScan, WholeCoordinatesAreMetresAndAMissingOneIsNamed) {
  const ScanPoints scan = read({{"x", 'I', 2, 1, {-5, 300}}, {"y", 'I', 4, 1, {1, 2}}, {"z", 'U', 1, 1, {3, 200}}});
  EXPECT_EQ(scan.points[0].x, -5.0F);
  EXPECT_EQ(scan.points[1].z, 200.0F);
  EXPECT_EQ(scan.points[1].intensity, 0.0F);
  expectThrows<Error>([&] { read({x(), y(), {"Z_", 'F', 4, 1, kZ}}); }, {"a.pcd", "no field z"});
}

TEST_F(PcdScan, TheUnitOfTimesIsToldFromTheirSpan) {
  const double epoch_s = 1700000000.0;
  const struct {
    char type;
    int size;
    std::vector<double> values;
    double first_s, last_s;
  } cases[] = {
      {'U', 4, {0, 1, 2, 1.0e8}, 0.0, 0.1},     // ns
      {'U', 4, {0, 1, 2, 2.0e7}, 0.0, 0.02},    // ns, 50 Hz
      {'I', 4, {-100000, 1, 2, 0}, -0.1, 0.0},  // us, before the stamp
      {'U', 2, {0, 1, 2, 100}, 0.0, 0.1},       // ms
      {'U', 8, {epoch_s * 1e9, 1.7e18, 1.7e18, epoch_s * 1e9 + 1e8}, epoch_s, epoch_s + 0.1},
      {'U', 8, {epoch_s * 1e6, 1.7e15, 1.7e15, epoch_s * 1e6 + 1e5}, epoch_s, epoch_s + 0.1},
      {'U', 8, {epoch_s * 1e9, 1.7e18, 1.7e18, epoch_s * 1e9 + 4e9}, epoch_s, epoch_s + 4.0},  // of several scans
      {'F', 4, {0.0, 0.01, 0.02, 0.1}, 0.0, 0.1},
      {'F', 8, {epoch_s, epoch_s, epoch_s, epoch_s + 0.1}, epoch_s, epoch_s + 0.1},
      {'F', 8, {epoch_s * 1e9, 1.7e18, 1.7e18, epoch_s * 1e9 + 1e8}, epoch_s, epoch_s + 0.1},
      {'F', 4, {0.0, 3.0, 2.0, 99.0}, 0.0, 0.099},     // ms
      {'F', 4, {0.0, 0.001, 0.0, 0.002}, 0.0, 0.002},  // a few packets
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.type + std::to_string(c.size) + ' ' + std::to_string(c.values.back()));
    const std::vector<double> times_s = times(c.type, c.size, c.values);
    ASSERT_EQ(times_s.size(), 4U);
    EXPECT_NEAR(times_s.front(), c.first_s, 1e-6);
    EXPECT_NEAR(times_s.back(), c.last_s, 1e-6);
  }
  // The third point is no return: its time does not count.
  EXPECT_NEAR(times('U', 4, {1000, 2000, 4e9, 101000}).back(), 0.101, 1e-9);
  EXPECT_TRUE(times('U', 4, {5, 5, 7, 5}).empty());
}

TEST_F(PcdScan, RingsThatSayNothingAreLeftOut) {
  const auto rings = [&](const std::vector<double>& values) {
    return read({x(), y(), z(), {"ring", 'F', 4, 1, values}}).rings;
  };
  EXPECT_EQ(rings({0, 1, kNan, 2}), (std::vector<std::uint16_t>{0, 1, 0, 2}));  // the third point is no return
  EXPECT_TRUE(rings({4, 4, 4, 4}).empty());
  EXPECT_TRUE(rings({0, 1, 2, 2.5}).empty());
  EXPECT_TRUE(rings({0, 1, 2, -1}).empty());
  EXPECT_TRUE(rings({0, kNan, 2, 1}).empty());
}

TEST_F(PcdScan, RowsAndColumnsAreKept) {
  const std::vector<TestField> fields = {x(), y(), z()};
  const auto read_shape = [&](const std::string& shape) {
    return readScanPoints(folder.write("a.pcd", pcdText(fields, "binary", shape)));
  };
  const ScanPoints organized = read_shape("WIDTH 2\nHEIGHT 2\n");
  expectThePoints(organized);
  EXPECT_EQ(organized.width, 2U);
  EXPECT_EQ(organized.height, 2U);
  EXPECT_EQ(viewOf(organized).height, 2U);
  for (const std::string shape : {"WIDTH 0\nHEIGHT 0\n", "WIDTH 0\nHEIGHT 1\n", ""}) {
    const ScanPoints scan = read_shape(shape);
    expectThePoints(scan);
    EXPECT_EQ(scan.width, 4U);
    EXPECT_EQ(scan.height, 1U);
  }
}

TEST_F(PcdScan, HeadsAreCheckedWhole) {
  const std::string good = pcdText({x(), y(), z()}, "ascii");
  EXPECT_NO_THROW(readScanPoints(folder.write("a.pcd", good)));
  const struct {
    std::string from, to, place, reason;
  } cases[] = {
      {"VERSION 0.7\n", "\r\nVERSION 0.7\n", "line 2", "line of blanks"},
      {"DATA", " \t\nDATA", "line 11", "line of blanks"},
      {"WIDTH 4", "WIDTH 65536", "line 11", "WIDTH 65536 times HEIGHT 1 is not POINTS 4"},
      {"WIDTH 4\nHEIGHT 1", "WIDTH 4294967297\nHEIGHT 4294967296", "line 11", "is not POINTS"},
      {"WIDTH 4", "WIDTH -1", "line 7", "WIDTH is no whole number"},
      {"POINTS 4", "POINTS 4x", "line 10", "POINTS is no whole number"},
      {"POINTS 4", "POINTS 0", "line 11", "not POINTS 0"},
      {"SIZE 4 4 4", "SIZE 4 4", "line 4", "a number for each field"},
      {"SIZE 4 4 4", "SIZE 4 4 4 4", "line 4", "more words"},
      {"SIZE 4 4 4", "SIZE 4 4 3", "line 11", "field z has the type F of 3 bytes"},
      {"SIZE 4 4 4\n", "", "line 10", "no SIZE"},
      {"TYPE F F F", "TYPE F F X", "line 11", "field z has the type X"},
      {"TYPE F F F", "TYPE F F F\nTYPE U U U", "line 6", "TYPE is given twice"},
      {"VIEWPOINT 1", "VIEWPOINT one", "line 9", "VIEWPOINT needs 7 numbers"},
      {"FIELDS x y z\nSIZE 4 4 4", "SIZE 4 4 4\nFIELDS x y z", "line 3", "SIZE before FIELDS"},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.to);
    std::string bad = good;
    bad.replace(bad.find(c.from), c.from.size(), c.to);
    const auto path = folder.write("a.pcd", bad);
    expectThrows<Error>([&] { readScanPoints(path); }, {"a.pcd: " + c.place + ": ", c.reason});
  }
  // The lines of a file from elsewhere may end in CR LF.
  std::string other_ends;
  for (const char c : good) other_ends += c == '\n' ? std::string("\r\n") : std::string(1, c);
  expectThePoints(readScanPoints(folder.write("a.pcd", other_ends)));
  expectThePoints(readScanPoints(folder.write("a.pcd", "\xEF\xBB\xBF" + good)));
}

TEST_F(PcdScan, AsciiValuesAreCheckedOneByOne) {
  const std::string head = pcdText({x(), y(), z(), {"label", 'U', 1, 1, kRing}}, "ascii");
  const std::string first = "1.5 5 -1 3 ";
  ASSERT_NE(head.find(first), std::string::npos);
  const auto with = [&](const std::string& line) {
    std::string text = head;
    text.replace(text.find(first), first.size(), line);
    return folder.write("a.pcd", text);
  };
  EXPECT_TRUE(std::isnan(readScanPoints(with("nan 5 -1e0 3.0")).points[0].x));
  const std::pair<const char*, const char*> cases[] = {{"1.5 5 -1", "line 12: 3 numbers, where 4 are needed"},
                                                       {"1 2 3 4 5", "5 numbers"},
                                                       {"abc 2 3 1", "line 12: 'abc' is no number"},
                                                       {"4,5 2 3 1", "'4,5'"},
                                                       {"0x8 2 3 1", "'0x8'"},
                                                       {"1 2 3 -1", "'-1' is no number of the field label"},
                                                       {"1 2 3 256", "'256'"},
                                                       {"1 2 3 1.5", "'1.5'"},
                                                       {"1 2 3 nan", "'nan'"},
                                                       {"1 2 3 1\n1 2 3 1", "line 16: more points than the 4"}};
  for (const auto& [line, reason] : cases) {
    expectThrows<Error>([&, text = line] { readScanPoints(with(text)); }, {"a.pcd", reason});
  }
}

TEST_F(PcdScan, CompressedDataThatClaimTooMuchAreRefused) {
  std::string head = pcdText({x(), y(), z()}, "binary");
  head = head.substr(0, head.find("DATA")) + "DATA binary_compressed\n";
  const auto with = [&](std::uint32_t compressed, std::uint32_t bytes, std::size_t data) {
    const std::uint32_t sizes[] = {compressed, bytes};
    return folder.write(
        "a.pcd", head + std::string(reinterpret_cast<const char*>(sizes), sizeof(sizes)) + std::string(data, 'x'));
  };
  expectThrows<Error>([&] { readScanPoints(with(3, 0xfffffff0U, 3)); }, {"4294967280 bytes are announced", "48"});
  expectThrows<Error>([&] { readScanPoints(with(300, 48, 3)); }, {"cut short"});
  expectThrows<Error>([&] { readScanPoints(with(3, 48, 3)); }, {"a.pcd", "damaged"});
}

}  // namespace
}  // namespace saw_ndt
