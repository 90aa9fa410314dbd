#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <Eigen/Geometry>
#include <random>
#include <utility>
#include <vector>

#include "map/ndt_level.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/common/labels.h"
#include "saw_ndt/map/ndt_target.h"
#include "saw_ndt/map/weighted_map_builder.h"
#include "saw_ndt/pcl/cloud_view.h"
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
    add(along(random), along(random), 0.03f + noise(random), StructuralLabel::GROUND);
    add(along(random), 5.4f + noise(random), up(random), StructuralLabel::NON_GROUND);
    add(-4.3f + noise(random), along(random), up(random), StructuralLabel::NON_GROUND);
    if (i % 10 == 0) add(2.2f + noise(random), -1.7f + noise(random), up(random), StructuralLabel::NON_GROUND);
  }
  return cloud;
}

inline SourcePoints sourceOf(const pcl::PointCloud<pcl::PointXYZL>& cloud, bool labelled = true) {
  SourcePoints source;
  source.labelled = labelled;
  for (const auto& p : cloud) {
    source.add(p.x, p.y, p.z, labelled ? static_cast<StructuralLabel>(p.label) : StructuralLabel::NON_GROUND);
  }
  return source;
}

/// Pairs appear and vanish where a point crosses the face of a voxel of 1 m (DIRECT) or a sphere around a mean
/// (RADIUS), which no derivative describes and where rounding decides: leaves out the points within 1 mm of such an
/// event at T.
inline SourcePoints awayFromEvents(const SourcePoints& source, const Eigen::Isometry3d& T,
                                   const internal::NdtLevel& level) {
  const std::vector<Eigen::Vector3d> means = level.means();
  SourcePoints kept;
  kept.labelled = source.labelled;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const Eigen::Vector3d p = T * Eigen::Vector3d(source.x[i], source.y[i], source.z[i]);
    bool keep = ((p.array() - p.array().round()).abs() > 1e-3).all();
    const VoxelCoordinate voxel = p.array().floor().matrix().cast<int>();
    for (int z = -1; z <= 1; ++z) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
          const auto number = level.index().find(voxel + VoxelCoordinate(x, y, z));
          if (number < 0) continue;
          const double distance = (p - means[static_cast<std::size_t>(number)]).norm();
          keep = keep && std::abs(distance - 1.0) > 1e-3;
        }
      }
    }
    if (keep) kept.add(source.x[i], source.y[i], source.z[i], static_cast<StructuralLabel>(source.label[i]));
  }
  return kept;
}

/// The target of a labelled cloud in 1 m voxels, with cells in double precision too.
inline NdtTarget exactTargetOf(const pcl::PointCloud<pcl::PointXYZL>& cloud,
                               const Eigen::Isometry3d& T_map_cloud = Eigen::Isometry3d::Identity(),
                               const VoxelWeighting& weighting = {}) {
  WeightedMapBuilder builder(1.0);
  addCloud(builder, cloud, T_map_cloud);
  return NdtTarget(std::move(builder).build(), weighting, 1, CellPrecision::SINGLE_AND_DOUBLE);
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
