#include "saw_ndt/pcl/range_image_segmentation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "saw_ndt/pcl/impl/range_image_segmentation.hpp"
#include "segmentation/synthetic_scan.h"

struct PointWithRing {
  PCL_ADD_POINT4D
  std::uint16_t ring = 0;
  PCL_MAKE_ALIGNED_OPERATOR_NEW
};
POINT_CLOUD_REGISTER_POINT_STRUCT(PointWithRing, (float, x, x)(float, y, y)(float, z, z)(std::uint16_t, ring, ring))

namespace saw_ndt {

using namespace internal;

namespace {

SensorModel testSensor() { return SensorModel::evenlySpaced("test", 32, 720, 6.0, -25.0); }

// Ground, walls and single returns in the sky.
double sceneRange(int row, int column) {
  const SensorModel sensor = testSensor();
  if (row < 3) return column % 9 == 0 && row == 1 ? 20.0 : kNoReturn;
  if (row < 18 && column % 90 < 40) return 8.2 / std::cos(radiansFromDegrees(sensor.elevations_deg[row]));
  return rangeToFlatGround(sensor, row, 40.0);
}

pcl::PointCloud<pcl::PointXYZ>::Ptr scene() {
  return pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>(organizedScan(testSensor(), sceneRange));
}

SegmentationOptions testOptions() {
  SegmentationOptions options;
  options.sensor = testSensor();
  return options;
}

pcl::Indices merged(const pcl::Indices& first, const pcl::Indices& second) {
  pcl::Indices all = first;
  all.insert(all.end(), second.begin(), second.end());
  std::sort(all.begin(), all.end());
  return all;
}

TEST(RangeImageSegmentation, KeptAndRemovedAreTheInput) {
  const auto cloud = scene();
  pcl::Indices every(cloud->size());
  pcl::Indices third;
  for (std::size_t i = 0; i < every.size(); ++i) {
    every[i] = static_cast<pcl::index_t>(i);
    if (i % 3 != 1) third.push_back(every[i]);
  }
  for (const bool negative : {false, true}) {
    for (const bool subset : {false, true}) {
      RangeImageSegmentation<pcl::PointXYZ> filter(true);
      filter.setOptions(testOptions());
      filter.setInputCloud(cloud);
      filter.setNegative(negative);
      if (subset) filter.setIndices(pcl::make_shared<pcl::Indices>(third));
      pcl::Indices kept;
      filter.filter(kept);
      EXPECT_EQ(merged(kept, *filter.getRemovedIndices()), subset ? third : every);
      EXPECT_FALSE(kept.empty());
      EXPECT_FALSE(filter.getRemovedIndices()->empty());
      for (const pcl::index_t index : kept) {
        ASSERT_EQ(filter.getLabels()[index] == StructuralLabel::NOISE, negative);
      }
      pcl::PointCloud<pcl::PointXYZ> output;
      filter.filter(output);
      EXPECT_EQ(output.size(), kept.size());
    }
  }
}

TEST(RangeImageSegmentation, PointsThatAreNotSelectedAreNoise) {
  const auto cloud = scene();
  RangeImageSegmentation<pcl::PointXYZ> filter;
  filter.setOptions(testOptions());
  filter.setInputCloud(cloud);
  auto half = pcl::make_shared<pcl::Indices>();
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    if (i % cloud->width < cloud->width / 2) half->push_back(static_cast<pcl::index_t>(i));
  }
  filter.setIndices(half);
  pcl::Indices kept;
  filter.filter(kept);
  EXPECT_GT(kept.size(), 1000U);
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    if (i % cloud->width >= cloud->width / 2) {
      ASSERT_EQ(filter.getLabels()[i], StructuralLabel::NOISE);
    }
  }
}

TEST(RangeImageSegmentation, KeepsOrganizedCloudsOrganized) {
  const auto cloud = scene();
  for (const float value : {std::numeric_limits<float>::quiet_NaN(), -7.0F}) {
    RangeImageSegmentation<pcl::PointXYZ> filter(true);
    filter.setOptions(testOptions());
    filter.setInputCloud(cloud);
    filter.setKeepOrganized(true);
    filter.setUserFilterValue(value);
    pcl::PointCloud<pcl::PointXYZ> output;
    filter.filter(output);
    ASSERT_EQ(output.width, cloud->width);
    ASSERT_EQ(output.height, cloud->height);
    for (std::size_t i = 0; i < output.size(); ++i) {
      if (filter.getLabels()[i] != StructuralLabel::NOISE) {
        ASSERT_EQ(output[i].x, (*cloud)[i].x);
      } else if (std::isnan(value)) {
        ASSERT_TRUE(std::isnan(output[i].x));
      } else {
        ASSERT_EQ(output[i].x, value);
      }
    }
  }
}

TEST(RangeImageSegmentation, SegmentLabelsEveryPointInInputOrder) {
  auto cloud = scene();
  cloud->header.frame_id = "lidar";
  RangeImageSegmentation<pcl::PointXYZ> filter;
  filter.setOptions(testOptions());
  filter.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointXYZL> labelled;
  filter.segment(labelled);
  ASSERT_EQ(labelled.size(), cloud->size());
  EXPECT_EQ(labelled.width, cloud->width);
  EXPECT_EQ(labelled.header.frame_id, "lidar");
  std::array<std::size_t, kStructuralLabelCount> counts{};
  for (std::size_t i = 0; i < labelled.size(); ++i) {
    ASSERT_EQ(labelled[i].label, static_cast<std::uint32_t>(filter.getLabels()[i]));
    ASSERT_EQ(std::isnan((*cloud)[i].x), std::isnan(labelled[i].x));
    if (!std::isnan(labelled[i].x)) {
      ASSERT_EQ(labelled[i].z, (*cloud)[i].z);
    }
    ++counts[labelled[i].label];
  }
  for (const std::size_t count : counts) EXPECT_GT(count, 100U);
}

TEST(RangeImageSegmentation, PointTypesAgree) {
  const auto cloud = scene();
  pcl::PointCloud<pcl::PointXYZI>::Ptr with_intensity(new pcl::PointCloud<pcl::PointXYZI>);
  pcl::PointCloud<PointWithRing>::Ptr with_ring(new pcl::PointCloud<PointWithRing>);
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    pcl::PointXYZI point;
    point.getVector3fMap() = (*cloud)[i].getVector3fMap();
    with_intensity->push_back(point);
    PointWithRing ringed;
    ringed.getVector3fMap() = (*cloud)[i].getVector3fMap();
    ringed.ring = static_cast<std::uint16_t>(31 - i / cloud->width);
    with_ring->push_back(ringed);
  }
  pcl::PointCloud<pcl::PointXYZL> expected;
  RangeImageSegmentation<pcl::PointXYZ> filter;
  filter.setOptions(testOptions());
  filter.setInputCloud(cloud);
  filter.segment(expected);
  pcl::PointCloud<pcl::PointXYZL> labelled;
  RangeImageSegmentation<pcl::PointXYZI> intensity_filter;
  intensity_filter.setOptions(testOptions());
  intensity_filter.setInputCloud(with_intensity);
  intensity_filter.segment(labelled);
  EXPECT_EQ(intensity_filter.getLabels(), filter.getLabels());
  RangeImageSegmentation<PointWithRing> ring_filter;
  ring_filter.setOptions(testOptions());
  ring_filter.setInputCloud(with_ring);
  ring_filter.segment(labelled);
  EXPECT_EQ(ring_filter.getLabels(), filter.getLabels());
}

TEST(RangeImageSegmentation, EmptyAndMissingInputGiveEmptyOutput) {
  RangeImageSegmentation<pcl::PointXYZ> filter;
  pcl::PointCloud<pcl::PointXYZL> labelled;
  labelled.resize(3);
  filter.segment(labelled);
  EXPECT_TRUE(labelled.empty());
  filter.setInputCloud(pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>());
  pcl::Indices kept = {1, 2};
  filter.filter(kept);
  EXPECT_TRUE(kept.empty());
}

}  // namespace
}  // namespace saw_ndt
