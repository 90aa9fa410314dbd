#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <Eigen/Geometry>
#include <random>

#include "saw_ndt/common/geometry.h"
#include "saw_ndt/common/labels.h"
#include "saw_ndt/registration/source_points.h"

namespace saw_ndt {

/// A street corner of about 12 m: ground, two walls at a right angle and a pole, with 1 cm of noise. Every direction of
/// a pose is constrained. Ground points are labelled ground, the rest non-ground.
inline pcl::PointCloud<pcl::PointXYZL> streetCorner(unsigned seed, int points_per_surface = 4000) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> along(-6.0f, 6.0f), up(0.0f, 3.0f);
  std::normal_distribution<float> noise(0.0f, 0.01f);
  pcl::PointCloud<pcl::PointXYZL> cloud;
  const auto add = [&](float x, float y, float z, StructuralLabel label) {
    pcl::PointXYZL point;
    point.x = x;
    point.y = y;
    point.z = z;
    point.label = static_cast<std::uint32_t>(label);
    cloud.push_back(point);
  };
  for (int i = 0; i < points_per_surface; ++i) {
    add(along(random), along(random), 0.03f + noise(random), StructuralLabel::Ground);
    add(along(random), 5.4f + noise(random), up(random), StructuralLabel::NonGround);
    add(-4.3f + noise(random), along(random), up(random), StructuralLabel::NonGround);
    if (i % 10 == 0) add(2.2f + noise(random), -1.7f + noise(random), up(random), StructuralLabel::NonGround);
  }
  return cloud;
}

inline SourcePoints sourceOf(const pcl::PointCloud<pcl::PointXYZL>& cloud, bool labelled = true) {
  SourcePoints source;
  source.labelled = labelled;
  for (const auto& p : cloud) {
    source.add(p.x, p.y, p.z, labelled ? static_cast<StructuralLabel>(p.label) : StructuralLabel::NonGround);
  }
  return source;
}

/// A pose whose every component is uniform within the bounds (m, rad).
inline Eigen::Isometry3d randomPose(std::mt19937& random, double translation_m, double rotation_rad) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  Eigen::Vector3d rotation_vector;
  for (int i = 0; i < 3; ++i) {
    T.translation()[i] = translation_m * uniform(random);
    rotation_vector[i] = rotation_rad * uniform(random);
  }
  T.linear() = rotationFromVector(rotation_vector);
  return T;
}

}  // namespace saw_ndt
