#include "saw_ndt/io/polygon_file.h"

#include <gtest/gtest.h>

#include "expect_throws.h"
#include "saw_ndt/common/error.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

class PolygonFile : public ::testing::Test {
 protected:
  std::vector<Eigen::Vector2d> read(const std::string& content) const {
    return readPolygon(folder.write("p.txt", content));
  }

  TemporaryFolder folder;
};

TEST_F(PolygonFile, OfTextOrCsvHasItsVerticesOnce) {
  const std::vector<Eigen::Vector2d> expected = {{0, 0.5}, {2, 0}, {-2e3, 1}};
  EXPECT_EQ(read("0 0.5\n2 0\n-2e3 1\n"), expected);
  EXPECT_EQ(read("# x y\n\n0 0.5\r\n2\t0\n  -2000 +1\n0 0.5"), expected);
  EXPECT_EQ(read("0,0.5\n2, 0\n-2e3,1\n0,0.5\n"), expected);
  EXPECT_EQ(read("x,y\n0,0.5\n2,0\n-2e3,1\n"), expected);
  EXPECT_EQ(read("name,Y_m,\"X_m\"\na,0.5,0\nb,0,2\nc,1,-2e3\n"), expected);
}

TEST_F(PolygonFile, WhatIsNoVertexIsNamedByItsLine) {
  expectThrows<Error>([&] { read("0 0\n\n1 a\n1 1\n"); }, {"p.txt: line 3: 'a'"});
  expectThrows<Error>([&] { read("0 0\n1 nan\n1 1\n"); }, {"p.txt: line 2: 'nan'"});
  expectThrows<Error>([&] { read("0 0\n1 1 1\n1 0\n"); }, {"p.txt: line 2: 3 numbers"});
  expectThrows<Error>([&] { read("0,0\n1,1,1\n1,0\n"); }, {"p.txt: line 2: 3 values"});
  expectThrows<Error>([&] { read("x,y\n0,0\n1\n1,0\n"); }, {"p.txt: line 3: 1 values"});
  expectThrows<Error>([&] { read("0,0\n1,\n1,0\n"); }, {"p.txt: line 2: 0 numbers in column 2"});
  expectThrows<Error>([&] { read("x,z\n0,0\n1,1\n1,0\n"); }, {"p.txt: names no column y"});
  expectThrows<Error>([&] { read("0 0\n1 1\n0 0\n"); }, {"p.txt: ", "3 vertices or more", "has 2"});
  expectThrows<Error>([&] { read(""); }, {"p.txt: ", "has 0"});
  expectThrows<Error>([&] { readPolygon(folder.path() / "none.txt"); }, {"none.txt: No such file"});
}

}  // namespace
}  // namespace saw_ndt
