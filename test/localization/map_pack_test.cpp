#include "saw_ndt/localization/map_pack.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "expect_throws.h"
#include "localization/place_index.h"
#include "localization/place_table.h"
#include "localization/synthetic_drive.h"
#include "map/localization_map_file.h"
#include "map/map_fixtures.h"
#include "map/voxel_index.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/localization/global_search.h"
#include "saw_ndt/localization/localization_method.h"
#include "saw_ndt/localization/scan_preparation.h"
#include "temporary_folder.h"

namespace saw_ndt {

using namespace internal;

namespace {

/// Places like mixedCloud() here and there, on edges of tiles and of the blocks in which maps are packed.
WeightedVoxelMap scatteredMap(int points = 6000) {
  WeightedMapBuilder builder(0.5);
  unsigned seed = 0;
  for (const Eigen::Vector2d& at : std::vector<Eigen::Vector2d>{
           {0, 0}, {63.8, 20}, {512, -3}, {515, 511}, {-190, 320}, {-512.1, 512.2}, {900, -700}}) {
    for (int scan = 0; scan < 3; ++scan) {
      Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
      T.translation() << at, 0.5 * seed;
      addCloud(builder, mixedCloud(++seed, points), T);
    }
  }
  return std::move(builder).build();
}

VoxelWeighting weightingOf(const std::string& method) { return LocalizationMethod::named(method).voxels; }

using VoxelKey = std::tuple<int, int, int>;
std::map<VoxelKey, PackedNdtCell> cellsOf(const NdtLevel& level) {
  std::map<VoxelKey, PackedNdtCell> cells;
  const std::vector<VoxelCoordinate> voxels = level.index().voxels();
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    cells.emplace(VoxelKey{voxels[i].x(), voxels[i].y(), voxels[i].z()}, level.packedCells()[i]);
  }
  return cells;
}

bool sameBits(const PackedNdtCell& a, const PackedNdtCell& b) {
  return std::equal(a.mean_from_centre, a.mean_from_centre + 3, b.mean_from_centre) &&
         std::equal(a.inverse_covariance, a.inverse_covariance + 6, b.inverse_covariance) && a.weight == b.weight &&
         a.mean_confidence == b.mean_confidence && a.ground_share == b.ground_share;
}

class MapPack : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }
  LocalizationMap packed(const WeightedVoxelMap& map, const std::string& method = "weighted") const {
    pack(map, path(method), weightingOf(method));
    return LocalizationMap(path(method));
  }
  void pack(const WeightedVoxelMap& map, const std::string& file, const VoxelWeighting& weighting,
            int threads = 0) const {
    map.save(path("statistics"));
    packMap(path("statistics"), file, weighting, threads);
  }
  TemporaryFolder folder;
};

TEST_F(MapPack, HasTheVoxelsOfTheTargetOnEveryLevel) {
  const WeightedVoxelMap map = scatteredMap();
  for (const std::string& method : LocalizationMethod::names()) {
    SCOPED_TRACE(method);
    const NdtTarget exact(map, weightingOf(method));
    const LocalizationMap packed_map = packed(map, method);
    const NdtTarget read = packed_map.target();
    EXPECT_EQ(packed_map.voxelCount(), exact.voxelCount());
    EXPECT_EQ(packed_map.coarseVoxelCount(), exact.coarseVoxelCount());
    EXPECT_EQ(packed_map.origin().point_count, map.origin().point_count);
    EXPECT_EQ(packed_map.weighting(), weightingOf(method));
    ASSERT_EQ(read.levels().size(), exact.levels().size());
    const auto expectAlike = [](const NdtLevel& a, const NdtLevel& b) {
      const auto cells = cellsOf(a), expected = cellsOf(b);
      ASSERT_EQ(cells.size(), expected.size());
      for (const auto& [voxel, cell] : expected) {
        ASSERT_EQ(cells.count(voxel), 1U);
        const PackedNdtCell& found = cells.at(voxel);
        for (int axis = 0; axis < 3; ++axis) {
          EXPECT_NEAR(found.mean_from_centre[axis], cell.mean_from_centre[axis], b.resolution() * 0x1p-16);
        }
        EXPECT_NEAR(found.weight, cell.weight, 2e-5);
        EXPECT_NEAR(inverseCovarianceOf(found).trace(), inverseCovarianceOf(cell).trace(),
                    1e-3 * inverseCovarianceOf(cell).trace());
      }
    };
    for (std::size_t level = 0; level < exact.levels().size(); ++level) {
      ASSERT_GT(exact.levels()[level].size(), 0U);
      expectAlike(read.levels()[level], exact.levels()[level]);
    }
    expectAlike(read.coarse(), exact.coarse());
    // NdtTarget::load() reads either kind of file.
    EXPECT_EQ(NdtTarget::load(path(method), weightingOf(method)).voxelCount(), exact.voxelCount());
  }
}

TEST_F(MapPack, IsTheSameForAnyThreads) {
  const WeightedVoxelMap map = scatteredMap(40000);
  pack(map, path("one"), weightingOf("weighted"), 1);
  pack(map, path("four"), weightingOf("weighted"), 4);
  EXPECT_EQ(contentOf(path("one")), contentOf(path("four")));
}

TEST_F(MapPack, TilesAroundAPlaceHaveTheCellsOfTheWholeMap) {
  const LocalizationMap map = packed(scatteredMap());
  const NdtTarget whole = map.target();
  for (const Eigen::Vector3d& position :
       std::vector<Eigen::Vector3d>{{0, 0, 0}, {500, 0, 0}, {-300, 400, 5}, {1e7, -1e7, 0}}) {
    const double radius_m = 150.0;
    const NdtTarget around = map.targetAround(position, radius_m);
    for (std::size_t level = 0; level < whole.levels().size(); ++level) {
      const auto cells = cellsOf(around.levels()[level]), all = cellsOf(whole.levels()[level]);
      for (const auto& [voxel, cell] : cells) ASSERT_TRUE(sameBits(cell, all.at(voxel)));
      const double edge_m = whole.levels()[level].resolution();
      for (const auto& [voxel, cell] : all) {
        const Eigen::Vector2d centre_m((std::get<0>(voxel) + 0.5) * edge_m, (std::get<1>(voxel) + 0.5) * edge_m);
        ASSERT_EQ(cells.count(voxel), (centre_m - position.head<2>()).norm() <= radius_m ? 1U : 0U);
      }
    }
  }
  EXPECT_EQ(map.targetAround({0, 0, 0}, std::numeric_limits<double>::infinity()).voxelCount(), whole.voxelCount());
  EXPECT_TRUE(map.targetAround({std::nan(""), 0, 0}, 100.0).empty());
}

// Ground goes on beside what is seen of it, across the edges of what is packed at a time.
TEST_F(MapPack, HasTheSearchTablesOfTheWholeMap) {
  const LocalizationMap map = packed(scatteredMap());
  const PlaceIndex index(map.target());
  std::size_t found = 0;
  for (std::size_t i = 0; i < map.file().tileCount(); ++i) {
    const LocalizationTilePlace place = map.file().tile(i);
    if (place.table_bytes == 0) continue;
    ++found;
    PlaceIndex::Tile tile;
    ASSERT_TRUE(decodePlaceTile(map.file().searchTable(place), tile));
    const auto expected = std::find_if(index.tiles().begin(), index.tiles().end(), [&](const PlaceIndex::Tile& other) {
      return other.at.x == place.at.x && other.at.y == place.at.y;
    });
    ASSERT_NE(expected, index.tiles().end());
    EXPECT_EQ(tile.allowed, expected->allowed);
    for (int layer = 0; layer < kPlaceLayers; ++layer) {
      const auto* const words = tile.words.data() + layer * kPlaceTileRows;
      EXPECT_TRUE(std::equal(words, words + kPlaceTileSize, expected->words.data() + layer * kPlaceTileRows));
    }
    for (std::size_t k = 0; k < tile.ground_m.size(); ++k)
      EXPECT_NEAR(tile.ground_m[k], expected->ground_m[k], 0.00501);
  }
  EXPECT_EQ(found, index.tiles().size());
}

Eigen::Isometry3d streetPose(double x, double y, double yaw_deg) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << x, y, 1.73;
  T.linear() = rotationFromVector({0.0, 0.0, radiansFromDegrees(yaw_deg)});
  return T;
}

/// Streets here and there, of which one in two has lost a house.
WeightedVoxelMap streetsMap() {
  WeightedMapBuilder builder(0.5);
  ScanSegmenter segmenter{SegmentationOptions()};
  unsigned seed = 0;
  for (int street = 0; street < 4; ++street) {
    std::vector<Block> blocks = streetBlocks();
    if (street % 2 != 0) blocks.erase(blocks.begin());
    for (const double x : {-20.0, 0.0, 20.0}) {
      const std::vector<LidarPoint> scan =
          scanBlocks(blocks, SensorModel::named("HDL-64E"), streetPose(x, 1.0, 0.0), ++seed);
      std::vector<StructuralLabel> labels;
      segmenter.segment(viewOf(scan), labels);
      Eigen::Isometry3d T = streetPose(x, 1.0, 0.0);
      T.translation() += Eigen::Vector3d(700.0, -450.0, 3.0) * street;
      builder.addScan(viewOf(scan), LabelView(labels), T);
    }
  }
  return builder.build();
}

TEST_F(MapPack, IsSearchedAsItsWholeTarget) {
  const LocalizationMap map = packed(streetsMap());
  const GlobalSearch by_tables(map), by_target(map.target());
  ScanPreparationOptions options;
  options.segment = true;
  ScanPreparation preparation(options);
  unsigned seed = 100;
  for (const Eigen::Isometry3d& pose : {streetPose(-12.0, 2.0, 75.0), streetPose(5.0, -1.0, 200.0)}) {
    const SourcePoints& source =
        preparation.prepare(viewOf(scanBlocks(streetBlocks(), SensorModel::named("HDL-64E"), pose, ++seed)));
    SearchRegion second_street;
    second_street.T_map_base.translation() << 1400.0, -900.0, 0.0;
    second_street.radius_m = 60.0;
    for (const std::optional<SearchRegion>& region : {std::optional<SearchRegion>(), std::optional(second_street)}) {
      const std::vector<PoseCandidate> found = by_tables.candidates(source, region);
      const std::vector<PoseCandidate> expected = by_target.candidates(source, region);
      ASSERT_FALSE(expected.empty());
      ASSERT_EQ(found.size(), expected.size());
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].matched_share, expected[i].matched_share);
        EXPECT_EQ(found[i].T_map_base.linear(), expected[i].T_map_base.linear());
        // Heights are stored to a centimetre.
        EXPECT_LT((found[i].T_map_base.translation() - expected[i].T_map_base.translation()).norm(), 0.0051);
      }
    }
  }
}

TEST_F(MapPack, OfNothingHasNothing) {
  const LocalizationMap map = packed(WeightedMapBuilder(0.5).build());
  EXPECT_EQ(map.tileCount(), 0U);
  EXPECT_TRUE(map.target().empty());
  EXPECT_TRUE(map.targetAround(Eigen::Vector3d::Zero(), 100.0).empty());
}

TEST_F(MapPack, OfAMapThatReachesTooFarIsRefused) {
  for (const double x_m : {9e8, 1.1e9}) {
    SCOPED_TRACE(x_m);
    WeightedMapBuilder builder(2.0);
    std::vector<LidarPoint> points;
    for (int i = 0; i < 20; ++i)
      points.push_back({0.1F * static_cast<float>(i % 5), 0.1F * static_cast<float>(i / 5), 0.0F});
    Eigen::Isometry3d T_map_scan = Eigen::Isometry3d::Identity();
    T_map_scan.translation().x() = x_m;
    builder.addScan(viewOf(points), {}, T_map_scan);
    if (x_m < 9.6e8) {
      pack(builder.build(), path("far"), {});
      EXPECT_EQ(LocalizationMap(path("far")).target(1).voxelCount(), 1U);
    } else {
      expectThrows<Error>([&] { pack(builder.build(), path("too_far"), {}); }, {path("statistics"), "farther"});
      EXPECT_FALSE(std::filesystem::exists(path("too_far")));
    }
  }
}

TEST_F(MapPack, ForAnotherWeightingIsRefused) {
  const WeightedVoxelMap map = scatteredMap(1000);
  pack(map, path("paper"), weightingOf("weighted-s50"));
  expectThrows<Error>([&] { NdtTarget::load(path("paper"), weightingOf("weighted")); }, {path("paper"), "packed"});
  VoxelWeighting bad;
  bad.min_points_per_voxel = 0;
  expectThrows<std::invalid_argument>([&] { pack(map, path("bad"), bad); }, {"min_points_per_voxel"});
  WeightedMapBuilder fine(0.0005);
  expectThrows<Error>([&] { pack(fine.build(), path("bad"), {}); }, {path("statistics"), "millimetre"});
  EXPECT_FALSE(std::filesystem::exists(path("bad")));
}

}  // namespace
}  // namespace saw_ndt
