#include "saw_ndt/common/error.h"

#include <gtest/gtest.h>

namespace saw_ndt {
namespace {

using namespace std::string_literals;

TEST(Error, NamesFilePlaceAndReason) {
  EXPECT_STREQ(Error("a.map", "offset 3", "it is damaged").what(), "a.map: offset 3: it is damaged");
  EXPECT_STREQ(Error("a.map", "", "it is damaged").what(), "a.map: it is damaged");
}

TEST(Error, IsOneLineWithoutControlCharacters) {
  EXPECT_STREQ(Error("a\x1b[2J", "line 1", "'\0\x07\n\x7f' is no number"s).what(),
               "a\\x1b[2J: line 1: '\\x00\\x07 \\x7f' is no number");
  EXPECT_STREQ(Error("damaged\r").what(), "damaged\\x0d");
}

TEST(Error, ShortensWhatIsQuotedButNoNames) {
  const std::string long_text(10000, 'x');
  EXPECT_EQ(std::string(Error("a.map", "", long_text).what()), "a.map: " + long_text.substr(0, 500) + "...");
  EXPECT_LT(std::string(Error("a.map", "", std::string(1000, '\0')).what()).size(), 520U);
  EXPECT_EQ(std::string(Error(long_text, "", "it is damaged").what()), long_text + ": it is damaged");
}

}  // namespace
}  // namespace saw_ndt
