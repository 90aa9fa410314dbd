// Adding clouds run by run with vector code, against adding them point by point.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "common/instruction_set.h"
#include "map/map_tile.h"
#include "map_fixtures.h"
#include "saw_ndt/pcl/cloud_view.h"

namespace saw_ndt {
namespace {

using namespace internal;

using Cloud = pcl::PointCloud<pcl::PointXYZL>;
using Key = std::tuple<int, int, int, std::uint32_t>;

struct PlainSums {
  std::map<Key, VoxelSums> sums;
  std::uint64_t point_count = 0;
};

template <typename PointT>
PlainSums pointByPoint(const pcl::PointCloud<PointT>& cloud, const Eigen::Isometry3d& T_map_cloud,
                       double resolution_m) {
  PlainSums plain;
  for (const PointT& point : cloud) {
    QuantizedPosition position;
    if (!quantize(T_map_cloud * Eigen::Vector3d(point.x, point.y, point.z), 1.0 / resolution_m, position)) continue;
    auto label = static_cast<std::uint32_t>(StructuralLabel::NON_GROUND);
    if constexpr (pcl::traits::has_label<PointT>::value) label = point.label;
    plain.sums[{position.voxel.x(), position.voxel.y(), position.voxel.z(), label}].add(position.steps);
    ++plain.point_count;
  }
  return plain;
}

template <typename PointT>
void expectPlainSums(const pcl::PointCloud<PointT>& cloud, const Eigen::Isometry3d& T_map_cloud,
                     double resolution_m = 1.0) {
  const PlainSums expected = pointByPoint(cloud, T_map_cloud, resolution_m);
  for (const InstructionSet set :
       {InstructionSet::BASELINE, InstructionSet::SSE4, InstructionSet::AVX2, InstructionSet::AVX512}) {
    limitInstructionSet(set);
    for (const int threads : {1, 2, 3}) {
      WeightedMapBuilder builder(resolution_m);
      addCloud(builder, cloud, T_map_cloud, threads);
      const WeightedVoxelMap map = builder.build();
      EXPECT_EQ(map.origin().point_count, expected.point_count);
      ASSERT_EQ(map.entries().size(), expected.sums.size());
      for (const LabelledVoxelSums& entry : map.entries()) {
        const auto found = expected.sums.find(
            {entry.voxel.x(), entry.voxel.y(), entry.voxel.z(), static_cast<std::uint32_t>(entry.label)});
        ASSERT_NE(found, expected.sums.end()) << entry.voxel.transpose();
        ASSERT_EQ(entry.sums, found->second) << entry.voxel.transpose();
      }
    }
  }
  limitInstructionSet(InstructionSet::AVX512);
}

// Points that wander about, as those of a scan do: runs of every length.
Cloud wanderingCloud(unsigned seed, int points, float step_m) {
  std::mt19937 random(seed);
  std::normal_distribution<float> step(0.0F, step_m);
  Cloud cloud;
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  for (int i = 0; i < points; ++i) {
    position += Eigen::Vector3f(step(random), step(random), step(random));
    pcl::PointXYZL point;
    point.getVector3fMap() = position;
    point.label = static_cast<std::uint32_t>(i / 7 % 3);
    cloud.push_back(point);
  }
  return cloud;
}

Eigen::Isometry3d randomPose(std::mt19937& random, double extent_m) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = extent_m * Eigen::Vector3d(unit(random), unit(random), unit(random));
  T.linear() = Eigen::Quaterniond(unit(random), unit(random), unit(random), unit(random)).normalized().matrix();
  return T;
}

TEST(VoxelRuns, AnyPoseAndResolutionGiveThePlainSums) {
  std::mt19937 random(1);
  expectPlainSums(wanderingCloud(1, 50000, 0.1F), Eigen::Isometry3d::Identity());
  expectPlainSums(wanderingCloud(2, 45001, 1.0F), Eigen::Isometry3d::Identity(), 0.3);
  for (const double extent_m : {1.0, 1000.0, 5e6}) {
    for (const double resolution_m : {0.3, 1.0, 2.5}) {
      expectPlainSums(wanderingCloud(static_cast<unsigned>(extent_m), 3001, 0.2F), randomPose(random, extent_m),
                      resolution_m);
    }
  }
}

TEST(VoxelRuns, AnyPointTypeAndSizeGivesThePlainSums) {
  const Eigen::Isometry3d identity = Eigen::Isometry3d::Identity();
  for (int size = 0; size < 40; ++size) {
    const Cloud cloud = wanderingCloud(3, size, 0.4F);
    expectPlainSums(cloud, identity);
    expectPlainSums(withoutLabels(cloud), identity);
  }
  for (const int size : {511, 512, 513, 1024, 1031}) {
    const Cloud cloud = wanderingCloud(3, size, 0.02F);
    expectPlainSums(cloud, identity);
    expectPlainSums(withoutLabels(cloud), identity);
    // All in one voxel.
    expectPlainSums(withoutLabels(cloud), identity, 1000.0);
  }
}

TEST(VoxelRuns, PointsWithoutAVoxelArePassedOver) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::mt19937 random(4);
  Cloud cloud = wanderingCloud(4, 4000, 0.2F);
  for (const float bad :
       {kNan, kInfinity, -kInfinity, 1e30F, -3e9F, 2147483648.0F, std::numeric_limits<float>::max()}) {
    for (int i = 0; i < 60; ++i) cloud[random() % cloud.size()].data[random() % 3] = bad;
  }
  EXPECT_LT(pointByPoint(cloud, Eigen::Isometry3d::Identity(), 1.0).point_count, 3700U);
  expectPlainSums(cloud, Eigen::Isometry3d::Identity());
  expectPlainSums(cloud, randomPose(random, 100.0), 0.5);
  Cloud nothing(100, 1, cloud[0]);
  for (auto& point : nothing) point.y = kNan;
  expectPlainSums(nothing, Eigen::Isometry3d::Identity());
}

TEST(VoxelRuns, FacesOfVoxelsBelongWhereQuantizePutsThem) {
  Cloud cloud;
  for (const float x : {-3.0F, -1e-30F, -0.0F, 0.0F, 1e-30F, 2.0F, std::nextafter(2.0F, 0.0F), 7.00001F, 2.1e9F}) {
    for (const float y : {-2.0F, std::nextafter(-2.0F, 0.0F), std::nextafter(-2.0F, -3.0F), 5.5F, -2.1e9F}) {
      for (const float z : {-1.0F, 0.0F, 0.5F / 65536.0F, std::nextafter(1.0F, 0.0F), 1.0F}) {
        pcl::PointXYZL point;
        point.getVector3fMap() << x, y, z;
        point.label = 1;
        cloud.push_back(point);
      }
    }
  }
  expectPlainSums(cloud, Eigen::Isometry3d::Identity());
  expectPlainSums(cloud, Eigen::Isometry3d(Eigen::Translation3d(0.5, -4.0, 1e-12)), 0.5);
}

TEST(VoxelRuns, LevelsDoNotDependOnThreadsOrInstructionSet) {
  const Cloud cloud = mixedCloud(7, 60000, 40.0F);
  WeightedMapBuilder builder(0.5);
  addCloud(builder, cloud, Eigen::Isometry3d::Identity());
  limitInstructionSet(InstructionSet::BASELINE);
  const WeightedVoxelMap map = builder.build();
  ASSERT_GT(map.entries().size(), 4000U);
  const NdtTarget expected(map, {}, 1, CellPrecision::SINGLE_AND_DOUBLE);
  for (const InstructionSet set :
       {InstructionSet::BASELINE, InstructionSet::SSE4, InstructionSet::AVX2, InstructionSet::AVX512}) {
    limitInstructionSet(set);
    for (const int threads : {1, 2, 3, 0}) {
      expectEqualTargets(NdtTarget(map, {}, threads, CellPrecision::SINGLE_AND_DOUBLE), expected);
    }
  }
  limitInstructionSet(InstructionSet::AVX512);
}

TEST(MapOrder, HoldsFromOneEndOfTheCoordinatesToTheOther) {
  std::mt19937 random(5);
  // Tiles that fit into one 64-bit key, and tiles that do not.
  for (const int extent : {3000, 5000000, 2147480000}) {
    std::uniform_int_distribution<int> anywhere(-extent, extent);
    std::vector<LabelledVoxelSums> entries;
    for (int i = 0; i < 3000; ++i) {
      const VoxelCoordinate voxel(anywhere(random), anywhere(random), anywhere(random));
      for (const StructuralLabel label : {StructuralLabel::NON_GROUND, StructuralLabel::NOISE}) {
        entries.push_back({voxel, label, {}});
        entries.back().sums.add({i, -i, 7});
      }
    }
    std::vector<LabelledVoxelSums> expected = entries;
    std::sort(expected.begin(), expected.end(), inMapOrder);
    const auto same = [](const LabelledVoxelSums& a, const LabelledVoxelSums& b) {
      return a.voxel == b.voxel && a.label == b.label;
    };
    ASSERT_EQ(std::adjacent_find(expected.begin(), expected.end(), same), expected.end());
    const WeightedVoxelMap map({}, entries);
    ASSERT_EQ(map.entries().size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_TRUE(same(map.entries()[i], expected[i]));
      ASSERT_EQ(map.entries()[i].sums, expected[i].sums);
    }
  }
}

}  // namespace
}  // namespace saw_ndt
