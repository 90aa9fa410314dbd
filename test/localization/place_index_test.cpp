#include "localization/place_index.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <random>
#include <vector>

#include "common/instruction_set.h"

namespace saw_ndt::internal {
namespace {

/// Nine tiles of random bits, their repeated rows as they must be, and nothing in the empty layer.
class RandomTables {
 public:
  explicit RandomTables(unsigned seed) {
    std::mt19937_64 random(seed);
    for (auto& row : tiles_) {
      for (auto& tile : row) {
        tile.assign(kPlaceTileWords, 0);
        for (int layer = 0; layer < kPlaceLayers; ++layer) {
          for (int y = 0; y < kPlaceTileSize; ++y) tile[wordAt(layer, y)] = random() & random();
        }
      }
    }
    for (std::size_t ty = 0; ty < 3; ++ty) {
      for (std::size_t tx = 0; tx < 3; ++tx) {
        for (int layer = 0; layer < kPlaceLayers && ty + 1 < 3; ++layer) {
          for (int y = 0; y < kRowsAtOnce; ++y) {
            tiles_[ty][tx][wordAt(layer, kPlaceTileSize + y)] = tiles_[ty + 1][tx][wordAt(layer, y)];
          }
        }
        tables_.words[ty][tx] = tiles_[ty][tx].data();
      }
    }
  }

  const PlaceTables& tables() const { return tables_; }
  /// The bit of a column, counted from the middle tile's first one.
  bool has(int layer, int x, int y) const {
    const auto tile_x = static_cast<std::size_t>((x >> 6) + 1), tile_y = static_cast<std::size_t>((y >> 6) + 1);
    return ((tiles_[tile_y][tile_x][wordAt(layer, y & 63)] >> (x & 63)) & 1U) != 0;
  }

 private:
  static std::size_t wordAt(int layer, int row) { return static_cast<std::size_t>(layer * kPlaceTileRows + row); }

  std::array<std::array<std::vector<std::uint64_t>, 3>, 3> tiles_;
  PlaceTables tables_{};
};

struct Cell {
  int x, y, layer;
};

TEST(CountMatches, CountsWhatOneLookUpAfterTheOtherCounts) {
  for (const InstructionSet set : kInstructionSets) {
    limitInstructionSet(set);
    for (unsigned seed = 0; seed < 5; ++seed) {
      const RandomTables random_tables(seed);
      std::mt19937 random(seed);
      std::uniform_int_distribution<int> offset(-kPlaceTileSize, kPlaceTileSize - 1), layer(0, kPlaceLayers - 1);
      const std::size_t count = seed == 0 ? kMostOffsets : 8 * (1 + seed);
      std::vector<Cell> cells;
      std::vector<OutlineOffset> offsets;
      for (std::size_t i = 0; i < count; ++i) {
        const Cell cell{offset(random), offset(random), layer(random)};
        cells.push_back(cell);
        OutlineOffset& added = offsets.emplace_back();
        added.rows = static_cast<std::int16_t>(cell.y);
        added.shift = static_cast<std::uint8_t>(cell.x & 63);
        added.tile_x = cell.x < 0 ? 0 : 1;
        added.first_word = cell.layer * kPlaceTileRows;
      }
      offsets.back().first_word = kEmptyLayer * kPlaceTileRows;
      cells.pop_back();
      const int threshold = static_cast<int>(count) / 4;
      const std::uint64_t allowed[kRowsAtOnce] = {~std::uint64_t{0}, 0, 0xAAAAAAAAAAAAAAAA, ~std::uint64_t{0}};
      for (int first_row = 0; first_row < kPlaceTileSize; first_row += kRowsAtOnce) {
        PlaceCounts counts{};
        const bool any =
            countMatches(random_tables.tables(), offsets.data(), count, first_row, threshold, allowed, counts);
        bool expected_any = false;
        for (int row = 0; row < kRowsAtOnce; ++row) {
          for (int x = 0; x < kPlaceTileSize; ++x) {
            int expected = 0;
            for (const Cell& cell : cells) {
              expected += random_tables.has(cell.layer, x + cell.x, first_row + row + cell.y) ? 1 : 0;
            }
            const bool enough = expected >= threshold && ((allowed[row] >> x) & 1U) != 0;
            expected_any = expected_any || enough;
            if (!any) continue;
            ASSERT_EQ(((counts.enough[row] >> x) & 1U) != 0, enough);
            if (enough) {
              ASSERT_EQ(counts.count(row, x), expected);
            }
          }
        }
        ASSERT_EQ(any, expected_any);
      }
    }
  }
  limitInstructionSet(InstructionSet::AVX512);
}

TEST(GroundHeights, KeepTheLowestAndSpreadToTheNearest) {
  GroundHeights ground;
  ground.add({-0.5, 0.5, 2.0});
  ground.add({-0.2, 0.1, 1.0});
  ground.add({70.5, 0.5, 5.0});
  EXPECT_FLOAT_EQ(ground.at({-1, 0}).value(), 1.0F);
  EXPECT_FALSE(ground.at({3, 0}));
  EXPECT_EQ(ground.stepsToSeen({3, 0}), GroundHeights::kUnknown);
  ground.spread(40);
  EXPECT_FLOAT_EQ(ground.at({33, 0}).value(), 1.0F);
  EXPECT_FLOAT_EQ(ground.at({36, 0}).value(), 5.0F);
  EXPECT_EQ(ground.stepsToSeen({-1, 0}), 0);
  EXPECT_EQ(ground.stepsToSeen({-4, -5}), 8);
  EXPECT_FALSE(ground.at({-42, 0}));
}

TEST(LowestOf, LeavesOutWhatIsHigherThanItsSurroundings) {
  const std::vector<Eigen::Vector3d> points = {{0, 0, 0.0}, {3, 0, 0.4}, {5, 1, 2.5}, {60, 0, 7.0}};
  const std::vector<Eigen::Vector3d> lowest = lowestOf(points, 1.0);
  ASSERT_EQ(lowest.size(), 3U);
  EXPECT_EQ(lowest[2].z(), 7.0);
}

}  // namespace
}  // namespace saw_ndt::internal
