#include "saw_ndt/map/weighted_map_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include "expect_throws.h"
#include "map_fixtures.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/pcl/cloud_view.h"
#include "saw_ndt/version.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

using LabelledCloud = pcl::PointCloud<pcl::PointXYZL>;

Eigen::Isometry3d poseOf(int scan) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translate(Eigen::Vector3d(0.7 * scan, -0.1 * scan, 0.01 * scan));
  T.rotate(Eigen::AngleAxisd(0.05 * scan, Eigen::Vector3d(0.1, 0.2, 1.0).normalized()));
  return T;
}

std::string savedBytes(const WeightedVoxelMap& map) {
  const TemporaryFolder folder;
  map.save((folder.path() / "a.map").string());
  return contentOf(folder.path() / "a.map");
}

struct Scan {
  LabelledCloud cloud;
  Eigen::Isometry3d T_map_cloud;
};

std::vector<Scan> drive() {
  std::vector<Scan> scans;
  for (int i = 0; i < 9; ++i) scans.push_back({mixedCloud(static_cast<unsigned>(i), 1500), poseOf(i)});
  return scans;
}

WeightedMapBuilder builderOf(const std::vector<Scan>& scans) {
  WeightedMapBuilder builder(0.8);
  for (const Scan& scan : scans) addCloud(builder, scan.cloud, scan.T_map_cloud);
  return builder;
}

TEST(WeightedMapBuilder, AScanThatIsContinuedIsOneScan) {
  const LabelledCloud cloud = mixedCloud(4, 1500);
  LabelledCloud parts[3];
  for (std::size_t i = 0; i < cloud.size(); ++i) parts[i % 3].push_back(cloud[i]);
  WeightedMapBuilder whole(0.8), continued(0.8);
  for (int scan = 0; scan < 2; ++scan) addCloud(whole, cloud, poseOf(scan));
  addCloud(continued, cloud, poseOf(0));
  for (int part = 0; part < 3; ++part) {
    std::vector<StructuralLabel> labels;
    for (const auto& point : parts[part]) labels.push_back(static_cast<StructuralLabel>(point.label));
    const ScanView view = viewOf(parts[part]);
    if (part == 0) {
      continued.addScan(view, LabelView(labels), poseOf(1));
    } else {
      continued.continueScan(view, LabelView(labels), poseOf(1));
    }
  }
  EXPECT_EQ(continued.origin().scan_count, 2U);
  EXPECT_TRUE(savedBytes(continued.build()) == savedBytes(whole.build()));
  expectThrows<std::invalid_argument>([&] { continued.continueScan(viewOf(cloud), {}, poseOf(1)); },
                                      {"either labelled or unlabelled"});
}

TEST(WeightedMapBuilder, AnyOrderOfCloudsAndPointsGivesTheSameBytes) {
  std::vector<Scan> scans = drive();
  const std::string expected = savedBytes(builderOf(scans).build());
  std::mt19937 random(1);
  for (int trial = 0; trial < 5; ++trial) {
    std::shuffle(scans.begin(), scans.end(), random);
    for (Scan& scan : scans) std::shuffle(scan.cloud.begin(), scan.cloud.end(), random);
    EXPECT_TRUE(savedBytes(builderOf(scans).build()) == expected);
  }
}

TEST(WeightedMapBuilder, SavesAndCountsTileByTileWhatItsMapDoes) {
  WeightedMapBuilder builder(0.3);
  // Tiles on both sides of the origin, and some that lie too far apart for one number to order all voxels.
  const std::vector<Scan> scans = drive();
  for (const Scan& scan : scans) addCloud(builder, scan.cloud, scan.T_map_cloud);
  for (const double far_m : {-6e8, 6e8}) {
    Eigen::Isometry3d T_map_cloud = Eigen::Isometry3d::Identity();
    T_map_cloud.translation().setConstant(far_m);
    addCloud(builder, scans.front().cloud, T_map_cloud);
  }
  const WeightedVoxelMap map = builder.build();
  const TemporaryFolder folder;
  for (const int threads : {1, 3}) {
    const WrittenMap written = builder.save((folder.path() / "a.map").string(), threads);
    const std::string bytes = contentOf(folder.path() / "a.map");
    EXPECT_TRUE(bytes == savedBytes(map));
    EXPECT_EQ(written.entry_count, map.entries().size());
    EXPECT_EQ(written.voxel_count, map.voxelCount());
    EXPECT_EQ(written.file_bytes, bytes.size());
  }
  EXPECT_EQ(builder.entryCount(), map.entries().size());
  EXPECT_GT(map.voxelCount(), 200U);
  std::size_t next = 0;
  builder.forEachTile([&](const std::vector<LabelledVoxelSums>& entries) {
    for (const LabelledVoxelSums& entry : entries) {
      ASSERT_LT(next, map.entries().size());
      ASSERT_EQ(entry.voxel, map.entries()[next].voxel);
      ASSERT_EQ(entry.sums, map.entries()[next++].sums);
    }
  });
  EXPECT_EQ(next, map.entries().size());
}

TEST(WeightedMapBuilder, LimitedMemoryHoldsSoManySumsAndGivesTheSameBytes) {
  // The same places again and again, and some points of each scan behind the others.
  std::vector<Scan> scans = drive();
  const std::vector<Scan> again = scans;
  for (int lap = 0; lap < 2; ++lap) scans.insert(scans.end(), again.begin(), again.end());
  const auto addTo = [&](WeightedMapBuilder& builder, std::size_t first, std::size_t last) {
    std::size_t most = 0;
    for (std::size_t i = first; i < last; ++i) {
      const LabelledCloud& cloud = scans[i].cloud;
      std::vector<StructuralLabel> labels;
      for (const auto& point : cloud) labels.push_back(static_cast<StructuralLabel>(point.label));
      ScanView front = viewOf(cloud), rest = viewOf(cloud);
      front.size = cloud.size() / 2;
      rest.xyz = &cloud[front.size].x;
      rest.size = cloud.size() - front.size;
      const std::vector<StructuralLabel> rest_labels(labels.end() - static_cast<std::ptrdiff_t>(rest.size),
                                                     labels.end());
      builder.addScan(front, LabelView(labels), scans[i].T_map_cloud);
      builder.continueScan(rest, LabelView(rest_labels), scans[i].T_map_cloud);
      most = std::max(most, builder.entryCount());
    }
    return most;
  };
  WeightedMapBuilder free(0.8), limited(0.8), first_part(0.8), second_part(0.8), merged(0.8);
  const TemporaryFolder folder;
  constexpr std::size_t kMost = 500;
  for (WeightedMapBuilder* builder : {&limited, &first_part, &merged}) builder->limitMemory(kMost, folder.path());
  EXPECT_EQ(folder.entryCount(), 0U) << "the file has a name";
  const std::size_t of_one_scan = addTo(second_part, 20, 21);
  second_part = WeightedMapBuilder(0.8);
  addTo(free, 0, scans.size());
  ASSERT_GT(free.entryCount(), kMost + 2 * of_one_scan);
  EXPECT_LT(addTo(limited, 0, scans.size()), kMost + 2 * of_one_scan);
  const std::string expected = savedBytes(free.build());
  EXPECT_TRUE(savedBytes(limited.build()) == expected);
  for (const int threads : {1, 3}) {
    limited.save((folder.path() / "a.map").string(), threads);
    EXPECT_TRUE(contentOf(folder.path() / "a.map") == expected);
  }
  // A copy goes on by itself, and what is merged may be limited on either side.
  addTo(first_part, 0, 12);
  WeightedMapBuilder copy = first_part;
  addTo(copy, 12, scans.size());
  addTo(second_part, 12, scans.size());
  merged.merge(first_part);
  merged.merge(second_part);
  second_part.merge(first_part);
  for (const WeightedMapBuilder* builder : {&copy, &merged, &second_part}) {
    EXPECT_TRUE(savedBytes(builder->build()) == expected);
  }
  EXPECT_TRUE(savedBytes(std::move(limited).build()) == expected);
  EXPECT_TRUE(limited.build().entries().empty());
  expectThrows<std::invalid_argument>([&] { limited.limitMemory(0, folder.path()); }, {"most_entries = 0"});
  expectThrows<Error>([&] { free.limitMemory(1, folder.path() / "none"); }, {"none", "No such file"});
}

TEST(WeightedMapBuilder, MergedPartsGiveTheSameBytes) {
  const std::vector<Scan> scans = drive();
  const std::string expected = savedBytes(builderOf(scans).build());
  WeightedMapBuilder merged(0.8);
  merged.merge(WeightedMapBuilder(0.8));
  merged.merge(builderOf({scans.begin() + 6, scans.end()}));
  merged.merge(builderOf({scans.begin(), scans.begin() + 2}));
  merged.merge(WeightedMapBuilder(0.8));
  merged.merge(builderOf({scans.begin() + 2, scans.begin() + 6}));
  EXPECT_TRUE(savedBytes(merged.build()) == expected);
}

TEST(WeightedMapBuilder, AnyNumberOfThreadsGivesTheSameBytes) {
  const std::vector<Scan> scans = drive();
  const std::string expected = savedBytes(builderOf(scans).build());
  for (const std::size_t thread_count : {1U, 2U, 4U}) {
    std::vector<WeightedMapBuilder> parts(thread_count, WeightedMapBuilder(0.8));
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < thread_count; ++t) {
      threads.emplace_back([&, t] {
        for (std::size_t i = t; i < scans.size(); i += thread_count) {
          addCloud(parts[t], scans[i].cloud, scans[i].T_map_cloud);
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    WeightedMapBuilder merged(0.8);
    for (const WeightedMapBuilder& part : parts) merged.merge(part);
    EXPECT_TRUE(savedBytes(merged.build()) == expected);
  }
}

TEST(WeightedMapBuilder, CountsTheScansThatMetAVoxelWithALabel) {
  // Scan k has points in the voxels 0 to k along x, more of them than one thread takes, the even scans ground.
  constexpr int kScans = 5;
  std::vector<pcl::PointCloud<pcl::PointXYZL>> clouds(kScans);
  for (int scan = 0; scan < kScans; ++scan) {
    for (int i = 0; i < 50000; ++i) {
      pcl::PointXYZL point;
      point.getVector3fMap() << 0.5F + static_cast<float>(i % (scan + 1)), 0.5F, 0.5F;
      point.label = scan % 2 == 0 ? 1U : 2U;
      clouds[static_cast<std::size_t>(scan)].push_back(point);
    }
  }
  const auto identity = Eigen::Isometry3d::Identity();
  for (const int threads : {1, 2, 4}) {
    WeightedMapBuilder first(1.0), second(1.0);
    for (const auto& cloud : clouds) addCloud(&cloud < &clouds[3] ? first : second, cloud, identity, threads);
    first.merge(second);
    const WeightedVoxelMap map = first.build();
    for (const LabelledVoxelSums& entry : map.entries()) {
      std::uint32_t expected = 0;
      for (int scan = entry.voxel.x(); scan < kScans; ++scan) {
        expected += (scan % 2 == 0) == (entry.label == StructuralLabel::GROUND) ? 1U : 0U;
      }
      EXPECT_EQ(entry.scan_count, expected) << entry.voxel.x() << ' ' << threads;
    }
  }
}

TEST(WeightedMapBuilder, CountsWhatItWasGiven) {
  LabelledCloud cloud = mixedCloud(1, 100);
  cloud[3].x = std::numeric_limits<float>::quiet_NaN();
  cloud[4].z = std::numeric_limits<float>::infinity();
  cloud[5].y = 1e30F;
  WeightedMapBuilder builder(1.0);
  addCloud(builder, cloud, Eigen::Isometry3d::Identity());
  addCloud(builder, LabelledCloud(), Eigen::Isometry3d::Identity());
  const WeightedVoxelMap map = builder.build();
  EXPECT_EQ(map.origin().point_count, 97U);
  EXPECT_EQ(map.origin().scan_count, 2U);
  EXPECT_TRUE(map.labelled());
  std::uint64_t summed = 0;
  for (const LabelledVoxelSums& entry : map.entries()) summed += entry.sums.count;
  EXPECT_EQ(summed, 97U);
}

TEST(WeightedMapBuilder, PointsAtTheOriginOfAScanAreNoReturns) {
  std::vector<Scan> scans = drive();
  const std::string expected = savedBytes(builderOf(scans).build());
  pcl::PointXYZL no_return;
  no_return.label = 2;
  for (Scan& scan : scans) {
    for (auto at = scan.cloud.begin(); scan.cloud.end() - at > 7; at += 7) at = scan.cloud.insert(at, no_return);
  }
  EXPECT_TRUE(savedBytes(builderOf(scans).build()) == expected);

  // The origin of the map is a place as any other.
  LabelledCloud ahead;
  for (int i = 0; i < 10; ++i) {
    pcl::PointXYZL point;
    point.x = 5.0F;
    ahead.push_back(point);
  }
  Eigen::Isometry3d T_map_cloud = Eigen::Isometry3d::Identity();
  T_map_cloud.translation().x() = -5.0;
  WeightedMapBuilder builder(0.8);
  addCloud(builder, ahead, T_map_cloud);
  EXPECT_EQ(builder.origin().point_count, 10U);
}

TEST(WeightedMapBuilder, MemoryGrowsWithVoxelsNotWithPoints) {
  const Scan scan{mixedCloud(1, 3000), poseOf(1)};
  WeightedMapBuilder builder(1.0);
  addCloud(builder, scan.cloud, scan.T_map_cloud);
  const std::size_t entry_count = builder.build().entries().size();
  EXPECT_LT(entry_count, 3000U);
  for (int i = 0; i < 50; ++i) addCloud(builder, scan.cloud, scan.T_map_cloud);
  const WeightedVoxelMap map = builder.build();
  EXPECT_EQ(map.entries().size(), entry_count);
  EXPECT_EQ(map.origin().point_count, 51U * 3000U);
}

TEST(WeightedMapBuilder, LabelledAndUnlabelledCloudsDoNotMix) {
  const LabelledCloud labelled = mixedCloud(1, 50);
  const pcl::PointCloud<pcl::PointXYZ> plain = withoutLabels(labelled);
  const Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  WeightedMapBuilder with(1.0), without(1.0);
  addCloud(with, labelled, T);
  addCloud(without, plain, T);
  EXPECT_TRUE(with.build().labelled());
  EXPECT_FALSE(without.build().labelled());
  expectThrows<std::invalid_argument>([&] { addCloud(with, plain, T); }, {"labelled or unlabelled"});
  expectThrows<std::invalid_argument>([&] { addCloud(without, labelled, T); }, {"labelled or unlabelled"});
  expectThrows<std::invalid_argument>([&] { with.merge(without); }, {"labelled or unlabelled"});
  EXPECT_EQ(with.build().origin().scan_count, 1U);
  EXPECT_EQ(with.build().origin().point_count, 50U);
}

TEST(WeightedMapBuilder, RefusesWhatDoesNotHoldAndStaysAsItWas) {
  WeightedMapBuilder builder(1.0);
  LabelledCloud bad = mixedCloud(1, 50);
  bad[49].label = 3;
  const Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  expectThrows<std::invalid_argument>([&] { addCloud(builder, bad, T); }, {"label = 3"});
  Eigen::Isometry3d not_finite = T;
  not_finite.translation().x() = std::nan("");
  expectThrows<std::invalid_argument>([&] { addCloud(builder, mixedCloud(1, 50), not_finite); }, {"T_map_scan"});
  EXPECT_EQ(builder.build().origin().scan_count, 0U);
  EXPECT_TRUE(builder.build().entries().empty());
  expectThrows<std::invalid_argument>([&] { builder.merge(WeightedMapBuilder(0.5)); }, {"resolution_m = 0.5"});
  for (const double resolution_m : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    expectThrows<std::invalid_argument>([&] { WeightedMapBuilder{resolution_m}; }, {"resolution_m"});
  }
}

TEST(WeightedMapBuilder, ProjectedCoordinatesKeepTheirMillimetres) {
  const LabelledCloud cloud = mixedCloud(5, 6000);
  const Eigen::Isometry3d T_local = poseOf(3);
  WeightedMapBuilder at_origin(1.0);
  addCloud(at_origin, cloud, T_local);
  const WeightedVoxelMap expected = at_origin.build();
  // Multiples of the coarse voxel's 3 m, so that the voxels are the same ones.
  const VoxelCoordinate offset(500001, 4999998, -300);
  Eigen::Isometry3d T_far = T_local;
  T_far.translation() += offset.cast<double>();
  WeightedMapBuilder far(1.0);
  addCloud(far, cloud, T_far);
  const WeightedVoxelMap map = far.build();
  const std::vector<VoxelStatistics> near_voxels = expected.statistics(), far_voxels = map.statistics();
  ASSERT_EQ(far_voxels.size(), near_voxels.size());
  for (const VoxelStatistics& near_voxel : near_voxels) {
    const auto far_voxel = map.find((near_voxel.voxel + offset).cast<double>() + Eigen::Vector3d(0.5, 0.5, 0.5));
    ASSERT_TRUE(far_voxel);
    ASSERT_EQ(far_voxel->point_count, near_voxel.point_count);
    ASSERT_EQ(far_voxel->structure_class, near_voxel.structure_class);
    ASSERT_NEAR(far_voxel->weight, near_voxel.weight, 1e-12);
    ASSERT_LE((far_voxel->mean(1.0) - offset.cast<double>() - near_voxel.mean(1.0)).cwiseAbs().maxCoeff(), 1e-6);
    ASSERT_LE((far_voxel->covariance - near_voxel.covariance).cwiseAbs().maxCoeff(), 1e-6);
  }
  const NdtTarget near_target(expected), far_target(map);
  const std::vector<VoxelCoordinate> coarse_voxels = near_target.coarse().index().voxels();
  ASSERT_EQ(far_target.coarseVoxelCount(), coarse_voxels.size());
  for (const VoxelCoordinate& voxel : coarse_voxels) {
    ASSERT_NE(far_target.coarse().index().find(voxel + offset / 3), internal::VoxelIndex::kNone);
  }
}

TEST(WeightedMapBuilder, TellsHowItsLabelsWereMade) {
  SegmentationOptions segmentation;
  segmentation.ground.slope_deg = 9.0;
  WeightedMapBuilder builder(1.0, segmentation);
  addCloud(builder, mixedCloud(1, 100), Eigen::Isometry3d::Identity());
  const MapOrigin origin = builder.build().origin();
  EXPECT_EQ(origin.software_version, SAW_NDT_VERSION);
  ASSERT_TRUE(origin.segmentation);
  EXPECT_FALSE(firstDifference(*origin.segmentation, segmentation));
  expectThrows<std::invalid_argument>(
      [&] { addCloud(builder, withoutLabels(mixedCloud(1, 100)), Eigen::Isometry3d::Identity()); }, {"no labels"});
  segmentation.ground.slope_deg = -1.0;
  expectThrows<std::invalid_argument>([&] { WeightedMapBuilder(1.0, segmentation); }, {"slope_deg = -1"});
}

TEST(WeightedMapBuilder, BuildersOfOtherSegmentationsDoNotMerge) {
  SegmentationOptions segmentation;
  WeightedMapBuilder builder(1.0, segmentation);
  addCloud(builder, mixedCloud(1, 100), Eigen::Isometry3d::Identity());
  segmentation.ground.slope_deg = 9.25;
  expectThrows<std::invalid_argument>([&] { builder.merge(WeightedMapBuilder(1.0, segmentation)); },
                                      {"ground.slope_deg", " 10 ", " 9.25 "});
  expectThrows<std::invalid_argument>([&] { builder.merge(WeightedMapBuilder(1.0)); }, {"known"});
  EXPECT_EQ(builder.origin().scan_count, 1U);
}

TEST(WeightedMapBuilder, CopiesAreApartAndABuilderThatWasBuiltFromStartsAnew) {
  const std::vector<Scan> scans = drive();
  WeightedMapBuilder builder = builderOf(scans);
  const std::string expected = savedBytes(builder.build());
  const WeightedMapBuilder copy = builder;
  EXPECT_TRUE(savedBytes(std::move(builder).build()) == expected);
  EXPECT_TRUE(savedBytes(copy.build()) == expected);
  builder.merge(copy);
  EXPECT_TRUE(savedBytes(builder.build()) == expected);
}

}  // namespace
}  // namespace saw_ndt
