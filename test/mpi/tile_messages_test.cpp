#include "mpi/tile_messages.h"

#include <gtest/gtest.h>

#include <random>

#include "expect_throws.h"
#include "map/map_fixtures.h"
#include "map/map_tile.h"
#include "temporary_folder.h"

namespace saw_ndt::internal {
namespace {

std::string savedBytes(const WeightedMapBuilder& builder) {
  const TemporaryFolder folder;
  builder.save((folder.path() / "a.map").string());
  return contentOf(folder.path() / "a.map");
}

// Scans of some streets about the origin, where tiles of negative coordinates are.
void addScanOf(unsigned seed, WeightedMapBuilder& builder) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> anywhere(-300.0, 300.0);
  Eigen::Isometry3d T_map_cloud = Eigen::Isometry3d::Identity();
  T_map_cloud.translate(Eigen::Vector3d(anywhere(random), anywhere(random), 0.2 * anywhere(random)));
  addCloud(builder, mixedCloud(seed, 3000), T_map_cloud);
}

TEST(TileMessages, SumsThatWereSentToTheOwnersOfTheirTilesAreThoseOfOneBuilder) {
  for (const int ranks : {1, 2, 3, 5}) {
    WeightedMapBuilder whole(0.5, SegmentationOptions());
    std::vector<WeightedMapBuilder> owned(static_cast<std::size_t>(ranks), whole);
    for (unsigned part = 0; part < 6; ++part) {
      // What a rank collects before it sends: some scans.
      WeightedMapBuilder collected(0.5, SegmentationOptions());
      for (unsigned scan = 0; scan < 1 + part % 3; ++scan) {
        addScanOf(10 * part + scan, collected);
        addScanOf(10 * part + scan, whole);
      }
      const auto messages = messagesByOwner(collected, ranks);
      ASSERT_EQ(messages.size(), owned.size());
      for (std::size_t owner = 0; owner < owned.size(); ++owner) {
        for (const std::vector<char>& message : messages[owner]) addMessage(message, owned[owner]);
      }
    }
    WeightedMapBuilder together(0.5, SegmentationOptions());
    for (std::size_t rank = 0; rank < owned.size(); ++rank) {
      EXPECT_GT(owned[rank].entryCount(), 0U);
      owned[rank].forEachTile([&](const std::vector<LabelledVoxelSums>& entries) {
        EXPECT_EQ(ownerOfTile(tileOf(entries.front().voxel), ranks), static_cast<int>(rank));
      });
      together.merge(owned[rank]);
    }
    // The number of scans of the map is not sent along.
    MapOrigin without_scans = whole.origin();
    without_scans.scan_count = 0;
    WeightedMapBuilder expected(0.5, SegmentationOptions());
    expected.merge(WeightedVoxelMap(without_scans, whole.build().entries()));
    EXPECT_TRUE(savedBytes(together) == savedBytes(expected)) << ranks;
  }
}

TEST(TileMessages, AreKeptToSomeMegabytesEach) {
  // 400,000 voxels of 84 bytes.
  std::vector<LabelledVoxelSums> entries;
  for (int i = 0; i < 400000; ++i) {
    entries.push_back({{i % 1000, i / 1000, 0}, StructuralLabel::GROUND, {}, 1});
    entries.back().sums.add({1, 2, 3});
  }
  MapOrigin origin;
  origin.resolution_m = 0.5;
  origin.labelled = true;
  origin.segmentation = SegmentationOptions();
  origin.point_count = entries.size();
  WeightedMapBuilder collected(0.5, SegmentationOptions());
  collected.merge(WeightedVoxelMap(origin, std::move(entries)));
  const auto messages = messagesByOwner(collected, 1);
  ASSERT_GT(messages.front().size(), 1U);
  WeightedMapBuilder owned(0.5, SegmentationOptions());
  for (const std::vector<char>& message : messages.front()) {
    EXPECT_LT(message.size(), 18000000U);
    addMessage(message, owned);
  }
  EXPECT_EQ(owned.entryCount(), 400000U);
}

TEST(TileMessages, ThatAreCutOffAreRefused) {
  WeightedMapBuilder collected(0.5, SegmentationOptions()), owned(0.5, SegmentationOptions());
  addScanOf(1, collected);
  std::vector<char> message = messagesByOwner(collected, 1).front().front();
  message.pop_back();
  expectThrows<std::invalid_argument>([&] { addMessage(message, owned); }, {"ends in the middle of a tile"});
  EXPECT_EQ(owned.entryCount(), 0U);
}

}  // namespace
}  // namespace saw_ndt::internal
