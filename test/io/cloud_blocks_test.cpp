#include "io/cloud_blocks.h"

#include <gtest/gtest.h>

#include "expect_throws.h"
#include "io/pcd_text.h"
#include "saw_ndt/common/error.h"
#include "temporary_folder.h"

namespace saw_ndt::internal {
namespace {

std::vector<TestField> fields() {
  std::vector<TestField> list = {{"x", 'F', 8, 1, {}}, {"_", 'U', 1, 3, {}}, {"ring", 'U', 2, 1, {}}};
  for (int i = 0; i < 10; ++i) {
    list[0].values.push_back(5e6 + 0.001 * i);
    list[1].values.push_back(0.0);
    list[2].values.push_back(i);
  }
  return list;
}

TEST(CloudBlocks, AreTheFileInOrder) {
  const TemporaryFolder folder;
  for (const char* data : {"ascii", "binary"}) {
    const std::filesystem::path file = folder.write("a.pcd", pcdText(fields(), data));
    for (const std::size_t block_points : {1U, 3U, 10U, 11U}) {
      CloudBlocks blocks(file, block_points);
      PcdCloud block;
      std::size_t count = 0;
      while (blocks.next(block)) {
        ASSERT_EQ(blocks.firstPoint(), count);
        ASSERT_EQ(block.points, std::min<std::size_t>(block_points, 10 - count));
        for (const PcdColumn& column : block.columns) {
          block.forEach(column, [&](std::size_t point, double value) {
            const auto i = static_cast<double>(count + point);
            const double expected[] = {5e6 + 0.001 * i, 0.0, i};
            EXPECT_EQ(value, expected[&column - block.columns.data()]);
          });
        }
        count += block.points;
      }
      EXPECT_EQ(count, 10U);
      EXPECT_FALSE(blocks.next(block));
    }
  }
}

TEST(CloudBlocks, CompressedPointsBeyondTheBoundAreRefused) {
  const TemporaryFolder folder;
  std::string text = pcdText(fields(), "binary");
  text = text.substr(0, text.find("WIDTH")) + "WIDTH 200000000\nHEIGHT 1\nPOINTS 200000000\nDATA binary_compressed\n";
  const std::uint32_t sizes[2] = {10000000, 2600000000U};
  text.append(reinterpret_cast<const char*>(sizes), sizeof(sizes)).append(sizes[0], '\0');
  expectThrows<Error>([&] { CloudBlocks(folder.write("a.pcd", text), 100); },
                      {"a.pcd", "offset", "2600000000 bytes are more than"});
}

}  // namespace
}  // namespace saw_ndt::internal
