#include <gtest/gtest.h>

#include "adversarial_clouds.h"
#include "expect_throws.h"
#include "map/ndt_level.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/localization/global_search.h"
#include "saw_ndt/map/moved_voxels.h"
#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/map/weighted_map_builder.h"
#include "temporary_folder.h"

namespace saw_ndt {

using namespace internal;

namespace {

std::vector<StructuralLabel> labelsByTurns(std::size_t count) {
  std::vector<StructuralLabel> labels(count);
  for (std::size_t i = 0; i < count; ++i) labels[i] = static_cast<StructuralLabel>(1 + i / 8 % 2);
  return labels;
}

/// Whether a point belongs into a map of voxels of 1 m: it is a return, and its voxel has a number.
bool hasVoxel(const LidarPoint& point) {
  const Eigen::Vector3f position = positionOf(point);
  return (position.array().abs() < 2147483000.0F).all() && !position.isZero(0.0F);
}

void expectSameEntries(const std::vector<LabelledVoxelSums>& a, const std::vector<LabelledVoxelSums>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].voxel, b[i].voxel);
    ASSERT_EQ(a[i].label, b[i].label);
    ASSERT_TRUE(a[i].sums == b[i].sums);
  }
}

WeightedMapBuilder builderOf(const std::vector<LidarPoint>& points) {
  const std::vector<StructuralLabel> labels = labelsByTurns(points.size());
  WeightedMapBuilder builder(1.0);
  builder.addScan(viewOf(points), LabelView(labels), Eigen::Isometry3d::Identity());
  return builder;
}

TEST(AdversarialMaps, HoldThePointsThatAreOnesAndAreReadAsTheyWereSaved) {
  forEveryAdversarialCloud([](const std::vector<LidarPoint>& points) {
    const WeightedMapBuilder builder = builderOf(points);
    const auto expected = static_cast<std::size_t>(std::count_if(points.begin(), points.end(), hasVoxel));
    EXPECT_EQ(builder.origin().point_count, expected);
    const WeightedVoxelMap map = builder.build();
    const TemporaryFolder folder;
    const std::string path = (folder.path() / "map.ndt").string();
    try {
      builder.save(path, 1);
    } catch (const Error&) {
      EXPECT_EQ(expected, 0U);
      EXPECT_EQ(folder.entryCount(), 0U);
      return;
    }
    expectSameEntries(WeightedVoxelMap::load(path).entries(), map.entries());
  });
}

TEST(AdversarialMaps, MakeTargetsOfFiniteCells) {
  forEveryAdversarialCloud([](const std::vector<LidarPoint>& points) {
    const WeightedMapBuilder builder = builderOf(points);
    const WeightedVoxelMap map = builder.build();
    VoxelWeighting several;
    several.sizes.finest_m = 0.5;
    several.sizes.coarsest_m = 4.0;
    several.unbounded_ground = true;
    for (const VoxelWeighting& weighting : {VoxelWeighting(), several}) {
      const NdtTarget target(map, weighting);
      std::vector<const NdtLevel*> levels = {&target.coarse()};
      for (const NdtLevel& level : target.levels()) levels.push_back(&level);
      for (const NdtLevel* level : levels) {
        for (const Eigen::Vector3d& mean : level->means()) ASSERT_TRUE(mean.allFinite());
        for (const PackedNdtCell& cell : level->packedCells()) {
          const Eigen::Matrix3d inverse_covariance = inverseCovarianceOf(cell);
          ASSERT_TRUE(inverse_covariance.allFinite()) << inverse_covariance;
          ASSERT_GT(inverse_covariance.trace(), 0.0);
          ASSERT_TRUE(cell.weight >= 0.0F && cell.weight <= 2.0F) << cell.weight;
        }
      }
      GlobalSearch(target).candidates({});
    }
  });
}

TEST(AdversarialMaps, AreLookedThroughForWhatMoved) {
  forEveryAdversarialCloud([](const std::vector<LidarPoint>& points) {
    const WeightedMapBuilder builder = builderOf(points);
    MovedVoxels moved(builder.build());
    const std::vector<LidarPoint> street = streetScan();
    for (const auto& scan : {points, street}) moved.addScan(viewOf(scan), Eigen::Isometry3d::Identity());
    EXPECT_LE(moved.remaining().origin().point_count, builder.origin().point_count);
  });
}

TEST(AdversarialLabels, ThatAreNoneAreRefusedAndTheBuilderStaysAsItWas) {
  const std::vector<LidarPoint> street = streetScan();
  const std::vector<StructuralLabel> good = labelsByTurns(street.size());
  WeightedMapBuilder builder(1.0);
  builder.addScan(viewOf(street), LabelView(good), Eigen::Isometry3d::Identity());
  const WeightedVoxelMap before = builder.build();
  for (const int value : {3, 7, 40, 255}) {
    std::vector<StructuralLabel> bad = good;
    bad.back() = static_cast<StructuralLabel>(value);
    const auto label = "label = " + std::to_string(value);
    for (const bool continues : {false, true}) {
      expectThrows<std::invalid_argument>(
          [&] {
            const Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
            continues ? builder.continueScan(viewOf(street), LabelView(bad), T)
                      : builder.addScan(viewOf(street), LabelView(bad), T);
          },
          {label});
    }
  }
  EXPECT_EQ(builder.origin().scan_count, 1U);
  expectSameEntries(builder.build().entries(), before.entries());
}

TEST(AdversarialResolutions, GiveAMapOrAreRefused) {
  const std::vector<LidarPoint> street = streetScan();
  for (const double resolution_m : {1e-9, 1e-6, 1e6, 1e9}) {
    SCOPED_TRACE(resolution_m);
    WeightedMapBuilder builder(resolution_m);
    builder.addScan(viewOf(street), {}, Eigen::Isometry3d::Identity());
    EXPECT_LE(builder.origin().point_count, street.size());
    const NdtTarget target(builder.build());
    for (const Eigen::Vector3d& mean : target.means()) ASSERT_TRUE(mean.allFinite());
  }
  for (const double resolution_m : {0.0, -1.0, 5e-324, 1e-30, 9e-10, 1.1e9, 1e30, 1.7e308, std::nan(""), HUGE_VAL}) {
    EXPECT_THROW(WeightedMapBuilder{resolution_m}, std::invalid_argument) << resolution_m;
  }
}

TEST(AdversarialPoses, OfAScanGiveAMapOrAreRefused) {
  const std::vector<LidarPoint> street = streetScan();
  for (const double metres : {1e8, 1e20, 1e300, -1.7e308}) {
    WeightedMapBuilder builder(1.0);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation().x() = metres;
    builder.addScan(viewOf(street), {}, T);
    EXPECT_EQ(builder.origin().point_count, metres == 1e8 ? street.size() : 0U) << metres;
    T.translation().y() = std::nan("");
    EXPECT_THROW(builder.addScan(viewOf(street), {}, T), std::invalid_argument);
  }
}

}  // namespace
}  // namespace saw_ndt
