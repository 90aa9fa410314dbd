#include "saw_ndt/map/ndt_target.h"

#include <gtest/gtest.h>

#include "expect_throws.h"
#include "map/map_tile.h"
#include "map_fixtures.h"
#include "saw_ndt/common/error.h"
#include "temporary_folder.h"

namespace saw_ndt {

using namespace internal;

namespace {

class NdtTargetFile : public ::testing::Test {
 protected:
  std::string saved(const WeightedVoxelMap& map) const {
    map.save(path);
    return path;
  }

  TemporaryFolder folder;
  const std::string path = (folder.path() / "a.map").string();
};

/// Sums of every voxel of some layers of two tiles, in several labels: more than a part or a piece of a file holds.
WeightedVoxelMap denseMap() {
  std::mt19937 random(1);
  std::uniform_int_distribution<std::int32_t> steps(-kStepsPerVoxel / 2, kStepsPerVoxel / 2);
  MapOrigin origin;
  origin.labelled = true;
  origin.scan_count = 1;
  std::vector<LabelledVoxelSums> entries;
  for (int z = 60; z < 68; ++z) {
    for (int y = 0; y < internal::kTileSize; ++y) {
      for (int x = 0; x < internal::kTileSize; ++x) {
        for (int label = 0; label < kStructuralLabelCount; ++label) {
          if (random() % 4 == 0) continue;
          LabelledVoxelSums& entry = entries.emplace_back();
          entry.voxel = {x, y, z};
          entry.label = static_cast<StructuralLabel>(label);
          for (int i = 0; i < 3; ++i) entry.sums.add({steps(random), steps(random), steps(random)});
          origin.point_count += 3;
        }
      }
    }
  }
  return {origin, std::move(entries)};
}

TEST_F(NdtTargetFile, LoadedTileByTileEqualsTheTargetOfTheWholeStoreBitForBit) {
  // Tiles have an edge of 32 m: coarse voxels of 3 and 5 lie across their edges.
  const WeightedVoxelMap map = mapOf(mixedCloud(1, 300000, 40.0F), 0.5);
  saved(map);
  for (const int factor : {1, 2, 3, 5}) {
    VoxelWeighting weighting;
    weighting.coarse_factor = factor;
    weighting.min_points_per_voxel = 3;
    weighting.confidence = ConfidenceOptions::paper();
    const NdtTarget expected(map, weighting);
    ASSERT_GT(expected.fine().tiles().size(), 4U);
    for (const int threads : {1, 2, 5}) {
      const NdtTarget loaded = NdtTarget::load(path, weighting, threads);
      expectEqualTargets(loaded, expected);
      EXPECT_TRUE(loaded.weighting() == weighting);
      EXPECT_EQ(loaded.origin().point_count, map.origin().point_count);
      EXPECT_EQ(loaded.coarseVoxelCount() == 0, factor == 1);
    }
  }
}

TEST_F(NdtTargetFile, ATileThatIsReadInPartsIsWhole) {
  const WeightedVoxelMap map = denseMap();
  ASSERT_GT(map.entries().size(), 60000U);
  saved(map);
  expectEqualTargets(NdtTarget::load(path, {}, 2), NdtTarget(map));
  const WeightedVoxelMap loaded = WeightedVoxelMap::load(path);
  ASSERT_EQ(loaded.entries().size(), map.entries().size());
  for (std::size_t i = 0; i < map.entries().size(); ++i) {
    ASSERT_EQ(loaded.entries()[i].voxel, map.entries()[i].voxel);
    ASSERT_EQ(loaded.entries()[i].label, map.entries()[i].label);
    ASSERT_EQ(loaded.entries()[i].sums, map.entries()[i].sums);
  }
}

TEST_F(NdtTargetFile, ADamagedPartOfATileIsRefused) {
  saved(denseMap());
  const std::string whole = contentOf(path);
  for (std::size_t i = whole.size() - 1; i > whole.size() / 50; i -= whole.size() / 17) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    const std::string file = folder.write("damaged.map", damaged).string();
    expectThrows<Error>([&] { NdtTarget::load(file); }, {file, "offset ", "damaged"});
    expectThrows<Error>([&] { WeightedVoxelMap::load(file); }, {file, "offset ", "damaged"});
  }
}

TEST_F(NdtTargetFile, RefusesAWeightingThatDoesNotHold) {
  const WeightedVoxelMap map = mapOf(mixedCloud(1, 1000));
  saved(map);
  VoxelWeighting weighting;
  weighting.coarse_factor = 0;
  expectThrows<std::invalid_argument>([&] { NdtTarget(map, weighting); }, {"coarse_factor = 0"});
  expectThrows<std::invalid_argument>([&] { NdtTarget::load(path, weighting); }, {"coarse_factor = 0"});
  expectThrows<Error>([&] { NdtTarget::load(path + ".none"); }, {"No such file"});
}

TEST(NdtTarget, AFactorOfOneMeansNoCoarseLevel) {
  VoxelWeighting weighting;
  weighting.coarse_factor = 1;
  const NdtTarget target(mapOf(mixedCloud(4, 1000)), weighting);
  EXPECT_EQ(target.coarseVoxelCount(), 0U);
  EXPECT_FALSE(target.empty());
}

TEST(NdtTarget, WithoutAMapIsEmpty) {
  for (const NdtTarget& target : {NdtTarget(), NdtTarget(WeightedVoxelMap())}) {
    EXPECT_TRUE(target.empty());
    EXPECT_EQ(target.coarseVoxelCount(), 0U);
    EXPECT_TRUE(target.means().empty());
    EXPECT_FALSE(target.labelled());
  }
}

TEST(NdtTarget, CopiesShareTheirLevelsAndOutliveTheMap) {
  NdtTarget copy;
  {
    const NdtTarget target(mapOf(mixedCloud(4, 2000)));
    copy = target;
    EXPECT_TRUE(copy.sharesLevelsWith(target));
    EXPECT_FALSE(NdtTarget(mapOf(mixedCloud(4, 2000))).sharesLevelsWith(target));
  }
  EXPECT_GT(copy.voxelCount(), 50U);
  EXPECT_EQ(copy.means().size(), copy.voxelCount());
}

}  // namespace
}  // namespace saw_ndt
