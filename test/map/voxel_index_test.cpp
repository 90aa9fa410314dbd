#include "map/voxel_index.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <tuple>

namespace saw_ndt::internal {
namespace {

/// What VoxelIndex does, the slow way.
class BruteForce {
 public:
  explicit BruteForce(const std::vector<VoxelCoordinate>& voxels) {
    for (std::size_t i = 0; i < voxels.size(); ++i) numbers_[keyOf(voxels[i])] = static_cast<std::int32_t>(i);
  }
  std::int32_t find(const VoxelCoordinate& voxel) const {
    const auto found = numbers_.find(keyOf(voxel));
    return found == numbers_.end() ? VoxelIndex::kNone : found->second;
  }

 private:
  static std::tuple<int, int, int> keyOf(const VoxelCoordinate& v) { return {v.x(), v.y(), v.z()}; }
  std::map<std::tuple<int, int, int>, std::int32_t> numbers_;
};

void expectNeighbours(const VoxelIndex& index, const BruteForce& expected, const VoxelCoordinate& voxel,
                      VoxelIndex::Cursor& cursor) {
  ASSERT_EQ(index.find(voxel), expected.find(voxel)) << voxel.transpose();
  const VoxelIndex::Place place = index.place(voxel, cursor);
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const std::int32_t number = place ? place.number(dx, dy, dz) : VoxelIndex::kNone;
        ASSERT_EQ(number, expected.find(voxel + VoxelCoordinate(dx, dy, dz)))
            << voxel.transpose() << " and " << dx << ' ' << dy << ' ' << dz;
      }
    }
  }
}

std::vector<VoxelCoordinate> distinct(const std::vector<VoxelCoordinate>& voxels) {
  std::map<std::tuple<int, int, int>, bool> seen;
  std::vector<VoxelCoordinate> result;
  for (const VoxelCoordinate& v : voxels) {
    if (!std::exchange(seen[std::make_tuple(v.x(), v.y(), v.z())], true)) result.push_back(v);
  }
  return result;
}

TEST(VoxelIndex, AgreesWithBruteForceEverywhere) {
  std::mt19937 random(1);
  // Dense and sparse; both reach over many bricks on either side of 0.
  for (const int extent : {9, 40}) {
    std::uniform_int_distribution<int> anywhere(-extent, extent);
    std::vector<VoxelCoordinate> voxels;
    for (int i = 0; i < 3000; ++i) voxels.emplace_back(anywhere(random), anywhere(random), anywhere(random));
    voxels = distinct(voxels);
    const VoxelIndex index(voxels);
    const BruteForce expected(voxels);
    EXPECT_EQ(index.voxels(), voxels);
    VoxelIndex::Cursor cursor;
    for (const VoxelCoordinate& voxel : voxels) expectNeighbours(index, expected, voxel, cursor);
    std::uniform_int_distribution<int> further(-extent - 20, extent + 20);
    for (int i = 0; i < 20000; ++i) {
      expectNeighbours(index, expected, {further(random), further(random), further(random)}, cursor);
    }
  }
}

TEST(VoxelIndex, OneVoxelInEachCornerOfABrickIsSeenFromEverySide) {
  for (const int x : {-9, -8, -1, 0, 7, 8}) {
    for (const int y : {-8, 0, 7}) {
      for (const int z : {-1, 3, 8}) {
        const std::vector<VoxelCoordinate> voxels{{x, y, z}};
        const VoxelIndex index(voxels);
        const BruteForce expected(voxels);
        VoxelIndex::Cursor cursor;
        for (int i = 0; i < 125; ++i) {
          expectNeighbours(index, expected, {x + i % 5 - 2, y + i / 5 % 5 - 2, z + i / 25 - 2}, cursor);
        }
      }
    }
  }
}

TEST(VoxelIndex, ReachesTheEndsOfTheCoordinates) {
  const std::vector<VoxelCoordinate> voxels{{2147482999, -2147483000, 0}, {-2147483000, 2147482999, 1}};
  const VoxelIndex index(voxels);
  EXPECT_EQ(index.find(voxels[0]), 0);
  EXPECT_EQ(index.find(voxels[1]), 1);
  EXPECT_EQ(index.find({0, 0, 0}), VoxelIndex::kNone);
  EXPECT_EQ(index.voxels(), voxels);
}

TEST(VoxelIndex, AFullBrickNumbersEveryCellAndItsBorder) {
  std::vector<VoxelCoordinate> voxels;
  for (int z = -9; z < 9; ++z) {
    for (int y = -9; y < 9; ++y) {
      for (int x = -9; x < 9; ++x) voxels.emplace_back(x, y, z);
    }
  }
  const VoxelIndex index(voxels);
  const BruteForce expected(voxels);
  VoxelIndex::Cursor cursor;
  for (const VoxelCoordinate& voxel : voxels) expectNeighbours(index, expected, voxel, cursor);
}

TEST(VoxelIndex, CountsOfTenBitsAreThoseOfTheirBits) {
  for (std::uint32_t bits = 0; bits < 1024; ++bits) {
    std::uint32_t count = 0;
    for (std::uint32_t left = bits; left != 0; left >>= 1U) count += left & 1U;
    ASSERT_EQ(countOfTenBits(bits), count);
    ASSERT_EQ(countOfTenBits(bits | 0xFFFFFC00U), count);
  }
}

TEST(VoxelIndex, AnEmptyIndexFindsNothing) {
  for (const VoxelIndex& index : {VoxelIndex(), VoxelIndex(std::vector<VoxelCoordinate>())}) {
    VoxelIndex::Cursor cursor;
    EXPECT_EQ(index.find({0, 0, 0}), VoxelIndex::kNone);
    EXPECT_FALSE(index.place({1, 2, 3}, cursor));
  }
}

}  // namespace
}  // namespace saw_ndt::internal
