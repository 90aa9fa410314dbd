#include "report/map_summary.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "report/voxel_cloud.h"
#include "saw_ndt/map/weighted_map_builder.h"
#include "saw_ndt/pcl/cloud_view.h"

namespace saw_ndt {
namespace {

using LabelledCloud = pcl::PointCloud<pcl::PointXYZL>;

void addPoint(LabelledCloud& cloud, float x, float y, float z, std::uint32_t label) {
  pcl::PointXYZL point;
  point.getVector3fMap() << x, y, z;
  point.label = label;
  cloud.push_back(point);
}

/// Three voxels of 0.5 m. (0, 0, 0): 8 points on a plane, 6 of them ground and 2 non-ground. (-4, 0, 0): 6 noise points
/// on a line. (10, -2, 3): one lone point, too few for a distribution.
WeightedVoxelMap threeVoxels() {
  LabelledCloud cloud;
  for (int i = 0; i < 8; ++i) {
    const auto row = static_cast<float>(i / 4), column = static_cast<float>(i % 4);
    addPoint(cloud, 0.05F + 0.1F * column, 0.1F + 0.25F * row, 0.25F, i < 6 ? 1 : 2);
  }
  for (int i = 0; i < 6; ++i) addPoint(cloud, -1.95F + 0.07F * static_cast<float>(i), 0.25F, 0.25F, 0);
  addPoint(cloud, 5.1F, -0.9F, 1.6F, 2);
  WeightedMapBuilder builder(0.5);
  addCloud(builder, cloud, Eigen::Isometry3d::Identity());
  return builder.build();
}

TEST(MapSummary, CountsByHand) {
  const MapSummary summary = summarize(threeVoxels());
  EXPECT_EQ(summary.resolution_m, 0.5);
  EXPECT_EQ(summary.coarse_resolution_m, 1.5);
  EXPECT_TRUE(summary.labelled);
  EXPECT_EQ(summary.scans, 1U);
  EXPECT_EQ(summary.points, 15U);
  EXPECT_EQ(summary.entries, 4U);
  EXPECT_EQ(summary.voxels, 2U);
  EXPECT_EQ(summary.coarse_voxels, 2U);
  EXPECT_EQ(summary.box_min_m, Eigen::Vector3d(-2.0, -1.0, 0.0));
  EXPECT_EQ(summary.box_max_m, Eigen::Vector3d(5.5, 0.5, 2.0));
  EXPECT_EQ(summary.label_points, (std::array<std::uint64_t, 3>{6, 6, 3}));
  EXPECT_EQ(summary.class_voxels, (std::array<std::size_t, 3>{1, 1, 0}));
  // Plane: (6 * 0.65 + 2 * 1) / 8 = 0.7375, times 1.25. Line: 0.85, times 0.75.
  EXPECT_DOUBLE_EQ(summary.mean_confidence.min, 0.7375);
  EXPECT_DOUBLE_EQ(summary.mean_confidence.max, 0.85);
  EXPECT_DOUBLE_EQ(summary.mean_confidence.mean, 0.79375);
  EXPECT_DOUBLE_EQ(summary.weight.min, 0.6375);
  EXPECT_DOUBLE_EQ(summary.weight.max, 0.921875);
  EXPECT_DOUBLE_EQ(summary.weight.mean, 0.7796875);
}

TEST(MapSummary, AsJsonAndAsText) {
  const MapSummary summary = summarize(threeVoxels());
  const auto json = nlohmann::json::parse(toJsonText(summary));
  EXPECT_EQ(json.at("voxels"), 2);
  EXPECT_EQ(json.at("box_min_m"), nlohmann::json({-2.0, -1.0, 0.0}));
  EXPECT_EQ(json.at("label_points").at("ground"), 6);
  EXPECT_DOUBLE_EQ(json.at("label_points").at("non_ground_share"), 0.2);
  EXPECT_DOUBLE_EQ(json.at("class_voxels").at("linear_share"), 0.5);
  EXPECT_EQ(json.at("class_voxels").at("volumetric"), 0);
  EXPECT_DOUBLE_EQ(json.at("weight").at("max"), 0.921875);
  const std::string text = toText(summary);
  EXPECT_NE(text.find("points                        15\n"), std::string::npos) << text;
  EXPECT_NE(text.find("label_points.noise_share      0.4\n"), std::string::npos) << text;
}

TEST(MapSummary, TellsHowTheMapWasMade) {
  MapOrigin origin = threeVoxels().origin();
  origin.segmentation = SegmentationOptions();
  origin.segmentation->ground.slope_deg = 9.5;
  origin.software_version = "1.2.3";
  const MapSummary summary = summarize(WeightedVoxelMap(origin, threeVoxels().entries()));
  const auto json = nlohmann::json::parse(toJsonText(summary));
  EXPECT_EQ(json.at("software_version"), "1.2.3");
  EXPECT_EQ(json.at("segmentation").at("sensor.name"), "HDL-64E");
  EXPECT_EQ(json.at("segmentation").at("sensor.elevations_deg").size(), 64U);
  EXPECT_EQ(json.at("segmentation").at("ground.rule"), "growing");
  EXPECT_EQ(json.at("segmentation").at("ground.slope_deg"), 9.5);
  EXPECT_EQ(json.at("segmentation").at("ground.smooths"), true);
  EXPECT_NE(toText(summary).find("segmentation.ground.slope_deg"), std::string::npos) << toText(summary);
}

TEST(MapSummary, TellsTheOriginAndDeadBytesWhereThereAreAny) {
  MapOrigin origin = threeVoxels().origin();
  EXPECT_EQ(toText(summarize(threeVoxels())).find("map_origin_m"), std::string::npos);
  EXPECT_EQ(toText(summarize(threeVoxels())).find("dead_bytes"), std::string::npos);
  origin.map_origin_m << 457000.0, 5432000.25, 0.0;
  MapSummary summary = summarize(WeightedVoxelMap(origin, threeVoxels().entries()));
  summary.dead_bytes = 77;
  EXPECT_NE(toText(summary).find("map_origin_m                  [457000.0,5432000.25,0.0]\n"), std::string::npos);
  EXPECT_NE(toText(summary).find("dead_bytes                    77\n"), std::string::npos);
}

TEST(MapSummary, SaysWhatIsNotKnown) {
  MapOrigin origin = threeVoxels().origin();
  origin.software_version.clear();
  const MapSummary summary = summarize(WeightedVoxelMap(origin, threeVoxels().entries()));
  const auto json = nlohmann::json::parse(toJsonText(summary));
  EXPECT_EQ(json.at("software_version"), "not known");
  EXPECT_EQ(json.at("segmentation"), "not known");
  EXPECT_NE(toText(summary).find("segmentation                  \"not known\"\n"), std::string::npos)
      << toText(summary);
}

TEST(MapSummary, AnUnlabelledMapTellsNoLabels) {
  pcl::PointCloud<pcl::PointXYZ> cloud;
  for (int i = 0; i < 10; ++i) cloud.push_back({0.1F * static_cast<float>(i), 0.5F, 0.5F});
  WeightedMapBuilder builder(1.0);
  addCloud(builder, cloud, Eigen::Isometry3d::Identity());
  VoxelWeighting weighting;
  weighting.coarse_factor = 1;
  const MapSummary summary = summarize(builder.build(), weighting);
  EXPECT_FALSE(summary.labelled);
  EXPECT_EQ(summary.coarse_resolution_m, 0.0);
  EXPECT_EQ(summary.voxels, 1U);
  const auto json = nlohmann::json::parse(toJsonText(summary));
  EXPECT_FALSE(json.contains("label_points"));
  EXPECT_FALSE(json.contains("segmentation"));
}

TEST(MapSummary, OfAnEmptyMapIsZero) {
  const MapSummary summary = summarize(WeightedMapBuilder(1.0).build());
  EXPECT_EQ(summary.points, 0U);
  EXPECT_EQ(summary.weight.max, 0.0);
  EXPECT_EQ(nlohmann::json::parse(toJsonText(summary)).at("class_voxels").at("linear_share"), 0.0);
}

TEST(VoxelCloud, TellsMeanLabelClassAndWeight) {
  const pcl::PointCloud<VoxelPoint> cloud = voxelCloud(threeVoxels());
  ASSERT_EQ(cloud.size(), 2U);
  // In the order of the map: by tile, and the line lies in tile -1.
  EXPECT_NEAR(cloud[0].x, -1.775, 1e-5);
  EXPECT_EQ(cloud[0].label, 0U);
  EXPECT_EQ(cloud[0].structure_class, 1.0F);
  EXPECT_EQ(cloud[0].weight, 0.6375F);
  EXPECT_NEAR(cloud[1].x, 0.2, 1e-5);
  EXPECT_NEAR(cloud[1].y, 0.225, 1e-5);
  EXPECT_NEAR(cloud[1].z, 0.25, 1e-5);
  EXPECT_EQ(cloud[1].label, 1U);
  EXPECT_EQ(cloud[1].structure_class, 2.0F);
  EXPECT_EQ(cloud[1].weight, 0.921875F);
}

TEST(VoxelCloud, LabelsThatTakeNoPartAreNoVoxelsLabel) {
  LabelledCloud cloud;
  for (int i = 0; i < 30; ++i) {
    addPoint(cloud, 0.03F * static_cast<float>(i), 0.01F * static_cast<float>(i % 7), 0.5F, i < 7 ? 1 : i < 14 ? 2 : 0);
  }
  WeightedMapBuilder builder(1.0);
  addCloud(builder, cloud, Eigen::Isometry3d::Identity());
  EXPECT_EQ(voxelCloud(builder.build()).front().label, 0U);
  VoxelWeighting weighting;
  weighting.confidence = ConfidenceOptions::paper();
  // Seven ground and seven non-ground points are left.
  EXPECT_EQ(voxelCloud(builder.build(), weighting).front().label, 2U);
}

}  // namespace
}  // namespace saw_ndt
