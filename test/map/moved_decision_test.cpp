#include "map/moved_decision.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace saw_ndt::internal {
namespace {

using Answer = std::vector<std::uint8_t>;

TEST(MovedDecision, AShareOfHitsBelowTheLimitMoves) {
  // Far from each other.
  EXPECT_EQ(voxelsThatMoved({{{0, 0, 0}, 29, 71}, {{9, 0, 0}, 30, 70}, {{18, 0, 0}, 31, 69}}, 0.3), (Answer{1, 0, 0}));
  EXPECT_EQ(voxelsThatMoved({{{0, 0, 0}, 9, 91}, {{9, 0, 0}, 10, 90}}, 0.1), (Answer{1, 0}));
  EXPECT_EQ(voxelsThatMoved({}, 0.3), Answer{});
}

TEST(MovedDecision, FewerThanThreeLooksThroughSayNothing) {
  EXPECT_EQ(voxelsThatMoved({{{0, 0, 0}, 1, 2}, {{9, 0, 0}, 1, 3}, {{18, 0, 0}, 0, 2}}, 0.5), (Answer{0, 1, 0}));
}

TEST(MovedDecision, VoxelsBesideThoseThatMoveGoWithAWeakerLimit) {
  const VoxelSightings moved{{0, 0, 0}, 1, 9}, doubtful{{1, 1, 1}, 9, 1}, solid{{1, 1, 1}, 10, 1},
      unseen{{1, 1, 1}, 5, 0};
  EXPECT_EQ(voxelsThatMoved({moved, doubtful}, 0.3), (Answer{1, 1}));
  EXPECT_EQ(voxelsThatMoved({moved, solid}, 0.3), (Answer{1, 0}));
  EXPECT_EQ(voxelsThatMoved({moved, unseen}, 0.3), (Answer{1, 0}));
  EXPECT_EQ(voxelsThatMoved({doubtful}, 0.3), Answer{0}) << "nothing beside it moves";
  EXPECT_EQ(voxelsThatMoved({moved, {{2, 0, 0}, 9, 1}}, 0.3), (Answer{1, 0})) << "no neighbour";
  // One neighbour in four.
  EXPECT_EQ(voxelsThatMoved({moved, doubtful, {{2, 1, 1}, 9, 0}, {{1, 2, 1}, 9, 0}, {{2, 2, 1}, 9, 0}}, 0.3),
            (Answer{1, 1, 0, 0, 0}));
  EXPECT_EQ(voxelsThatMoved(
                {moved, doubtful, {{2, 1, 1}, 9, 0}, {{1, 2, 1}, 9, 0}, {{2, 2, 1}, 9, 0}, {{2, 2, 2}, 9, 0}}, 0.3),
            (Answer{1, 0, 0, 0, 0, 0}));
}

TEST(MovedDecision, TheOrderOfVoxelsDoesNotMatter) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<VoxelSightings> voxels;
    std::uniform_int_distribution<int> sightings(0, 12);
    for (int x = -3; x < 4; ++x) {
      for (int y = -3; y < 4; ++y) {
        for (int z = -3; z < 4; ++z) {
          if (sightings(random) < 6) continue;
          voxels.push_back({{x, y, z},
                            static_cast<std::uint64_t>(sightings(random)) + 1,
                            static_cast<std::uint64_t>(sightings(random))});
        }
      }
    }
    const Answer expected = voxelsThatMoved(voxels, 0.2);
    const auto count = std::count(expected.begin(), expected.end(), 1);
    EXPECT_GT(count, 0);
    EXPECT_LT(count, static_cast<std::ptrdiff_t>(voxels.size()));
    std::vector<std::size_t> order(voxels.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), random);
    std::vector<VoxelSightings> shuffled;
    for (const std::size_t i : order) shuffled.push_back(voxels[i]);
    const Answer answer = voxelsThatMoved(shuffled, 0.2);
    for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(answer[i], expected[order[i]]);
  }
}

}  // namespace
}  // namespace saw_ndt::internal
