#pragma once

#include <gtest/gtest.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <string>

#include "map/ndt_level.h"
#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/map/weighted_map_builder.h"
#include "saw_ndt/pcl/cloud_view.h"

namespace saw_ndt {

/// A cloud of walls, poles, bushes and ground within +-`extent_m` of the origin, each part with its own label, so that
/// every structure class and every mixture of labels occurs. Metres.
inline pcl::PointCloud<pcl::PointXYZL> mixedCloud(unsigned seed, int points, float extent_m = 12.0F) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> anywhere(-extent_m, extent_m);
  std::normal_distribution<float> noise(0.0F, 0.02F);
  pcl::PointCloud<pcl::PointXYZL> cloud;
  for (int i = 0; i < points; ++i) {
    pcl::PointXYZL point;
    const float a = anywhere(random), b = anywhere(random);
    switch (i % 4) {
      case 0:
        point.getVector3fMap() << a, b, -1.6F + noise(random);
        point.label = 1;
        break;
      case 1:
        point.getVector3fMap() << a, 4.3F + noise(random), 0.2F * b;
        point.label = 2;
        break;
      case 2:
        point.getVector3fMap() << 2.4F + noise(random), -3.3F + noise(random), 0.2F * a;
        point.label = 2;
        break;
      default:
        point.getVector3fMap() << -6.5F + 0.1F * a, -6.5F + 0.1F * b, 0.1F * anywhere(random);
        point.label = i % 3 == 0 ? 0 : 2;
    }
    cloud.push_back(point);
  }
  return cloud;
}

inline pcl::PointCloud<pcl::PointXYZ> withoutLabels(const pcl::PointCloud<pcl::PointXYZL>& labelled) {
  pcl::PointCloud<pcl::PointXYZ> cloud;
  for (const pcl::PointXYZL& point : labelled) cloud.push_back({point.x, point.y, point.z});
  return cloud;
}

template <typename PointT>
WeightedVoxelMap mapOf(const pcl::PointCloud<PointT>& cloud, double resolution_m = 1.0) {
  WeightedMapBuilder builder(resolution_m);
  addCloud(builder, cloud, Eigen::Isometry3d::Identity());
  return builder.build();
}

/// Expects the same cells, bit for bit, of the same voxels.
inline void expectEqualLevels(const internal::NdtLevel& a, const internal::NdtLevel& b) {
  EXPECT_EQ(a.resolution(), b.resolution());
  ASSERT_EQ(a.index().voxels(), b.index().voxels());
  const auto sameFields = [](const auto& x, const auto& y) {
    return std::equal(std::begin(x.mean_from_centre), std::end(x.mean_from_centre), y.mean_from_centre) &&
           std::equal(std::begin(x.inverse_covariance), std::end(x.inverse_covariance), y.inverse_covariance) &&
           x.weight == y.weight && x.mean_confidence == y.mean_confidence;
  };
  EXPECT_TRUE(std::equal(a.packedCells().begin(), a.packedCells().end(), b.packedCells().begin(), b.packedCells().end(),
                         sameFields));
  EXPECT_TRUE(std::equal(a.cells().begin(), a.cells().end(), b.cells().begin(), b.cells().end(), sameFields));
}
inline void expectEqualTargets(const NdtTarget& a, const NdtTarget& b) {
  expectEqualLevels(a.fine(), b.fine());
  expectEqualLevels(a.coarse(), b.coarse());
}

inline std::string contentOf(const std::filesystem::path& path) {
  std::ostringstream content;
  content << std::ifstream(path, std::ios::binary).rdbuf();
  return content.str();
}

}  // namespace saw_ndt
