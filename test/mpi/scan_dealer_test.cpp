#include "mpi/scan_dealer.h"

#include <gtest/gtest.h>

#include <numeric>

namespace saw_ndt::internal {
namespace {

std::vector<int> numbered(int count) {
  std::vector<int> numbers(static_cast<std::size_t>(count));
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

TEST(ScanDealer, DealsOutEveryScanOfEveryDriveOnceAndInOrder) {
  const std::vector<std::vector<int>> scans = {{7, 3, 5}, {}, numbered(1000), {2}};
  for (const int ranks : {1, 2, 4, 1000}) {
    ScanDealer dealer(scans, ranks);
    EXPECT_EQ(dealer.scanCount(), 1004U);
    std::vector<std::vector<int>> dealt(scans.size());
    while (const std::optional<ScanChunk> chunk = dealer.next()) {
      EXPECT_FALSE(chunk->scans.empty());
      std::vector<int>& of_drive = dealt.at(static_cast<std::size_t>(chunk->drive));
      of_drive.insert(of_drive.end(), chunk->scans.begin(), chunk->scans.end());
    }
    EXPECT_EQ(dealt, scans) << ranks;
    EXPECT_FALSE(dealer.next());
  }
}

TEST(ScanDealer, ChunksShrinkSoThatARankThatTakesTheLastOneKeepsNobodyWaiting) {
  ScanDealer dealer({numbered(4541)}, 4);
  std::vector<std::size_t> sizes;
  while (const std::optional<ScanChunk> chunk = dealer.next()) sizes.push_back(chunk->scans.size());
  EXPECT_TRUE(std::is_sorted(sizes.rbegin(), sizes.rend()));
  EXPECT_EQ(sizes.front(), 32U);
  EXPECT_EQ(sizes.back(), 1U);
  // Four ranks ask for each chunk: what one takes is never more than a quarter of its part of what is left.
  std::size_t left = 4541;
  for (const std::size_t size : sizes) {
    EXPECT_LE(size, std::max<std::size_t>(1, left / 16));
    left -= size;
  }
}

}  // namespace
}  // namespace saw_ndt::internal
