#include "io/stamp_text.h"

#include <gtest/gtest.h>

#include "saw_ndt/io/trajectory.h"
#include "temporary_folder.h"

namespace saw_ndt::internal {
namespace {

TEST(StampOfDate, IsSecondsSince1970InUtc) {
  EXPECT_EQ(stampOfDate("1970-01-01 00:00:00"), 0.0);
  EXPECT_EQ(stampOfDate("2000-02-29T23:59:59Z"), 951868799.0);
  EXPECT_EQ(stampOfDate("2011-09-26 13:02:25.964389445"), 1317042145.964389445);
  EXPECT_EQ(stampOfDate("2011-09-26 13:02:25.5Z"), 1317042145.5);
}

TEST(StampOfDate, OtherTextIsNone) {
  for (const char* text : {"", "1317042145.9", "2011-09-26", "2011-09-26 13:02", "2011-13-26 13:02:25",
                           "2011-09-26 24:00:00", "2011-09-26 13:02:25.1a", "2011/09/26 13:02:25"}) {
    EXPECT_FALSE(stampOfDate(text).has_value()) << text;
  }
}

TEST(StampOfName, FractionsAndUnitsAreTold) {
  EXPECT_EQ(stampOfName("1700000000.123456789"), 1700000000.123456789);
  EXPECT_EQ(stampOfName("0.1"), 0.1);
  EXPECT_EQ(stampOfName("cloud_12.5"), 12.5);
  EXPECT_EQ(stampOfName("1700000000"), 1700000000.0);
  EXPECT_EQ(stampOfName("1700000000123"), 1700000000.123);
  EXPECT_EQ(stampOfName("1700000000123456"), 1700000000.123456);
  EXPECT_EQ(stampOfName("1700000000123456789"), 1700000000.123456789);
  EXPECT_EQ(stampOfName("1700000000_123456789"), 1700000000.123456789);
  EXPECT_EQ(stampOfName("scan-1700000000-000000005"), 1700000000.000000005);
}

TEST(StampOfName, NumbersOfScansAreNone) {
  for (const char* name :
       {"000012", "scan", "scan_7", "12_34", "1.2.3", "12.", "1700000000_12", "99999999999999999999"}) {
    EXPECT_FALSE(stampOfName(name).has_value()) << name;
  }
}

TEST(Stamps, OfDatesAreReadAsSeconds) {
  const TemporaryFolder folder;
  const auto file = folder.write("timestamps.txt", "2011-09-26 13:02:25.964389445\r\n2011-09-26 13:02:26.068 \n7.5\n");
  EXPECT_EQ(readStamps(file), (std::vector<double>{1317042145.964389445, 1317042146.068, 7.5}));
}

}  // namespace
}  // namespace saw_ndt::internal
