#include "common/printable.h"

#include <gtest/gtest.h>

#include "common/input_file.h"
#include "expect_throws.h"
#include "saw_ndt/common/error.h"
#include "temporary_folder.h"

namespace saw_ndt {

using namespace internal;

namespace {

TEST(Printable, ControlCharactersAreWrittenOut) {
  EXPECT_EQ(printable("a\x1b[31mb\tc\r\x7f"), "a\\x1b[31mb\\x09c\\x0d\\x7f");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printable("\xc2\x9b"
                      "31m"),
            "\\xc2\\x9b"
            "31m");  // what begins a command in UTF-8
}

TEST(Printable, AllElseStays) {
  for (const char* text : {"", "two\nlines", "C:\\x1b",
                           "stra\xc3\x9f"
                           "e",
                           "\xc2\xa0", "\xc2", "\xe2\x82\xac"}) {
    EXPECT_EQ(printable(text), text);
    EXPECT_EQ(printable(printable(text)), text);
  }
}

TEST(OpenTextFile, BeginsBehindAByteOrderMark) {
  const TemporaryFolder folder;
  const std::string mark = "\xEF\xBB\xBF";
  for (const std::string& text :
       {std::string("a 1"), std::string(), mark.substr(0, 1), mark.substr(0, 2) + "a", mark, std::string("\xEF\xBB")}) {
    for (const bool marked : {false, true}) {
      if (!marked && text == mark) continue;
      std::ifstream stream = openTextFile(folder.write("a.txt", (marked ? mark : "") + text));
      std::string read(10, '\0');
      stream.read(read.data(), 10);
      EXPECT_EQ(read.substr(0, static_cast<std::size_t>(stream.gcount())), text);
    }
  }
}

}  // namespace
}  // namespace saw_ndt
