#include "saw_ndt/pcl/ground_subsampling.h"

#include <gtest/gtest.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

namespace saw_ndt {
namespace {

std::vector<StructuralLabel> randomLabels(unsigned seed, std::size_t size) {
  std::mt19937 random(seed);
  std::vector<StructuralLabel> labels(size);
  for (StructuralLabel& label : labels) label = static_cast<StructuralLabel>(random() % 3);
  return labels;
}

/// The positions of the labels that GroundSampler keeps.
pcl::Indices keptBy(const std::vector<StructuralLabel>& labels, double ratio) {
  GroundSampler sampler({ratio});
  pcl::Indices kept;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (sampler.keepsNext(labels[i] == StructuralLabel::GROUND)) kept.push_back(static_cast<pcl::index_t>(i));
  }
  return kept;
}

pcl::PointCloud<pcl::PointXYZL>::Ptr cloudOf(const std::vector<StructuralLabel>& labels) {
  auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZL>>();
  for (std::size_t i = 0; i < labels.size(); ++i) {
    pcl::PointXYZL point;
    point.x = static_cast<float>(i);
    point.label = static_cast<std::uint32_t>(labels[i]);
    cloud->push_back(point);
  }
  return cloud;
}

TEST(GroundSubsampling, KeepsTheRatioOfGroundAndEveryOtherPoint) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    const auto labels = randomLabels(seed, 200 + 17 * seed);
    std::mt19937 random(seed);
    const double ratio = std::uniform_real_distribution<double>(0.0, 1.0)(random);
    const pcl::Indices kept = keptBy(labels, ratio);
    ASSERT_TRUE(std::is_sorted(kept.begin(), kept.end()));
    std::size_t ground = 0;
    std::size_t position = 0;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      bool expected = true;
      if (labels[i] == StructuralLabel::GROUND) {
        const auto k = static_cast<double>(ground++);
        expected = std::floor((k + 1.0) * ratio) > std::floor(k * ratio);
      }
      const bool keeps = position < kept.size() && kept[position] == static_cast<pcl::index_t>(i);
      ASSERT_EQ(keeps, expected) << "seed " << seed << " point " << i;
      position += keeps ? 1 : 0;
    }
    const auto others = static_cast<std::size_t>(std::count_if(
        labels.begin(), labels.end(), [](StructuralLabel label) { return label != StructuralLabel::GROUND; }));
    EXPECT_EQ(kept.size(), others + static_cast<std::size_t>(std::floor(static_cast<double>(ground) * ratio)));
  }
}

TEST(GroundSubsampling, HalfIsEveryOtherPointAndTheEndsAreAllOrNone) {
  const std::vector<StructuralLabel> labels(6, StructuralLabel::GROUND);
  EXPECT_EQ(keptBy(labels, 0.5), (pcl::Indices{1, 3, 5}));
  EXPECT_EQ(keptBy(labels, 1.0).size(), 6U);
  EXPECT_TRUE(keptBy(labels, 0.0).empty());
}

TEST(GroundSubsampling, RatiosOutsideOfZeroToOneAreRefused) {
  GroundSubsampling<pcl::PointXYZL> filter;
  for (const double ratio : {-0.1, 1.1, std::nan("")}) {
    EXPECT_THROW(filter.setOptions({ratio}), std::invalid_argument);
    EXPECT_THROW(GroundSampler({ratio}), std::invalid_argument);
  }
  EXPECT_EQ(filter.getOptions().ground_ratio, 0.5);
}

TEST(GroundSubsampling, FilterAgreesWithTheSamplerAndPartitionsItsInput) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto labels = randomLabels(seed, 300);
    const pcl::Indices expected = keptBy(labels, 0.3);
    for (const bool negative : {false, true}) {
      GroundSubsampling<pcl::PointXYZL> filter(true);
      filter.setOptions({0.3});
      filter.setInputCloud(cloudOf(labels));
      filter.setNegative(negative);
      pcl::Indices kept;
      filter.filter(kept);
      const pcl::Indices& removed = *filter.getRemovedIndices();
      EXPECT_EQ(negative ? removed : kept, expected);
      pcl::Indices all = kept;
      all.insert(all.end(), removed.begin(), removed.end());
      std::sort(all.begin(), all.end());
      ASSERT_EQ(all.size(), labels.size());
      for (std::size_t i = 0; i < all.size(); ++i) ASSERT_EQ(all[i], static_cast<pcl::index_t>(i));
    }
  }
}

TEST(GroundSubsampling, SetLabelsReplaceTheFieldAndMustMatch) {
  const auto labels = randomLabels(3, 100);
  auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  cloud->resize(labels.size());
  GroundSubsampling<pcl::PointXYZ> filter;
  filter.setInputCloud(cloud);
  pcl::Indices kept;
  EXPECT_THROW(filter.filter(kept), std::invalid_argument);
  filter.setLabels({StructuralLabel::GROUND});
  EXPECT_THROW(filter.filter(kept), std::invalid_argument);
  filter.setLabels(labels);
  filter.filter(kept);
  EXPECT_EQ(kept, keptBy(labels, 0.5));
}

TEST(GroundSubsampling, CountsOverTheGivenIndicesAlone) {
  GroundSubsampling<pcl::PointXYZL> filter;
  filter.setInputCloud(cloudOf(std::vector<StructuralLabel>(10, StructuralLabel::GROUND)));
  filter.setIndices(pcl::make_shared<pcl::Indices>(pcl::Indices{2, 5, 6, 9}));
  pcl::Indices kept;
  filter.filter(kept);
  EXPECT_EQ(kept, (pcl::Indices{5, 9}));
}

}  // namespace
}  // namespace saw_ndt
