#include "saw_ndt/drives/scan_selection.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "expect_throws.h"

namespace saw_ndt {
namespace {

struct SliceCase {
  const char* text;
  int scan_count;
  std::vector<int> selected;
};

// What Python 3 gives for list(range(scan_count))[text]; an empty list and an IndexError are both {}.
const SliceCase kPythonSlices[] = {
    {"7", 0, {}},
    {"-1", 0, {}},
    {"0", 0, {}},
    {":", 0, {}},
    {"::", 0, {}},
    {"2:", 0, {}},
    {"-3:", 0, {}},
    {":4", 0, {}},
    {":-4", 0, {}},
    {"1:10:2", 0, {}},
    {"0:70:2", 0, {}},
    {"::-1", 0, {}},
    {"8:2:-3", 0, {}},
    {"-1:-20:-4", 0, {}},
    {"20::-5", 0, {}},
    {"-100:100:4", 0, {}},
    {"5:1", 0, {}},
    {"::100", 0, {}},
    {"::-100", 0, {}},
    {"3:3", 0, {}},
    {"9223372036854775807:0:-1", 0, {}},
    {":5:-1", 0, {}},
    {"0:0:1", 0, {}},
    {"7", 1, {}},
    {"-1", 1, {0}},
    {"0", 1, {0}},
    {":", 1, {0}},
    {"::", 1, {0}},
    {"2:", 1, {}},
    {"-3:", 1, {0}},
    {":4", 1, {0}},
    {":-4", 1, {}},
    {"1:10:2", 1, {}},
    {"0:70:2", 1, {0}},
    {"::-1", 1, {0}},
    {"8:2:-3", 1, {}},
    {"-1:-20:-4", 1, {0}},
    {"20::-5", 1, {0}},
    {"-100:100:4", 1, {0}},
    {"5:1", 1, {}},
    {"::100", 1, {0}},
    {"::-100", 1, {0}},
    {"3:3", 1, {}},
    {"9223372036854775807:0:-1", 1, {}},
    {":5:-1", 1, {}},
    {"0:0:1", 1, {}},
    {"7", 10, {7}},
    {"-1", 10, {9}},
    {"0", 10, {0}},
    {":", 10, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}},
    {"::", 10, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}},
    {"2:", 10, {2, 3, 4, 5, 6, 7, 8, 9}},
    {"-3:", 10, {7, 8, 9}},
    {":4", 10, {0, 1, 2, 3}},
    {":-4", 10, {0, 1, 2, 3, 4, 5}},
    {"1:10:2", 10, {1, 3, 5, 7, 9}},
    {"0:70:2", 10, {0, 2, 4, 6, 8}},
    {"::-1", 10, {9, 8, 7, 6, 5, 4, 3, 2, 1, 0}},
    {"8:2:-3", 10, {8, 5}},
    {"-1:-20:-4", 10, {9, 5, 1}},
    {"20::-5", 10, {9, 4}},
    {"-100:100:4", 10, {0, 4, 8}},
    {"5:1", 10, {}},
    {"::100", 10, {0}},
    {"::-100", 10, {9}},
    {"3:3", 10, {}},
    {"9223372036854775807:0:-1", 10, {9, 8, 7, 6, 5, 4, 3, 2, 1}},
    {":5:-1", 10, {9, 8, 7, 6}},
    {"0:0:1", 10, {}},
};

TEST(ScanSelection, AgreesWithPython) {
  for (const SliceCase& slice : kPythonSlices) {
    SCOPED_TRACE(std::string(slice.text) + " of " + std::to_string(slice.scan_count));
    if (slice.selected.empty()) {
      expectThrows<std::invalid_argument>([&] { parseScanSelection(slice.text, slice.scan_count); }, {slice.text});
    } else {
      EXPECT_EQ(parseScanSelection(slice.text, slice.scan_count), slice.selected);
    }
  }
}

TEST(ScanSelection, RefusesWhatIsNoSlice) {
  for (const std::string text :
       {"", "a", "1:b", "1.5", "1:2:3:4", " 1", "0:10:0", "--1", "1e3", "99999999999999999999"}) {
    expectThrows<std::invalid_argument>([&] { parseScanSelection(text, 10); }, {"'" + text + "'"});
  }
}

TEST(ScanSelection, ShardsShareTheSelectedScansInTurn) {
  const std::vector<int> selected = {9, 7, 5, 3, 1};
  EXPECT_EQ(parseScanShard("1/1", selected), selected);
  EXPECT_EQ(parseScanShard("1/2", selected), (std::vector<int>{9, 5, 1}));
  EXPECT_EQ(parseScanShard("2/2", selected), (std::vector<int>{7, 3}));
  EXPECT_EQ(parseScanShard("5/5", selected), (std::vector<int>{1}));
  EXPECT_EQ(parseScanShard("2/18446744073709551615", selected), (std::vector<int>{7}));
  expectThrows<std::invalid_argument>([&] { parseScanShard("6/7", selected); }, {"'6/7'", "none of 5 scans"});
  for (const std::string text :
       {"", "1", "/", "1/", "/1", "0/2", "3/2", "1/2/3", "+1/2", "1/2 ", "1/1e9", "a/2", "1/99999999999999999999"}) {
    expectThrows<std::invalid_argument>([&] { parseScanShard(text, selected); }, {"'" + text + "'", "I/N"});
  }
}

}  // namespace
}  // namespace saw_ndt
