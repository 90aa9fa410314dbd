#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "saw_ndt/common/geometry.h"
#include "simulation/lidar_options.h"
#include "simulation/scene.h"
#include "simulation/vehicle_motion.h"

namespace saw_ndt {

/// How high the LiDAR stands in these tests (m); what stands on the ground below it is at z = 0 of the scene.
constexpr double kSensorHeight_m = 1.73;

/// A rectangle of two triangles with the corner `corner`, spanned by `u` and `v`.
inline TriangleMesh rectangle(const Eigen::Vector3f& corner, const Eigen::Vector3f& u, const Eigen::Vector3f& v,
                              std::uint16_t material = 0) {
  TriangleMesh mesh;
  mesh.vertices = {corner, corner + u, corner + u + v, corner + v};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.materials = {material, material};
  return mesh;
}

/// The level ground at height z, far beyond any range.
inline TriangleMesh ground(float z = 0.0f) { return rectangle({-500, -500, z}, {1000, 0, 0}, {0, 1000, 0}); }

/// The block from -half to +half on each axis, twelve triangles.
inline TriangleMesh block(const Eigen::Vector3f& half, std::uint16_t material = 0) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back((i & 1 ? 1.0f : -1.0f) * half.x(), (i & 2 ? 1.0f : -1.0f) * half.y(),
                               (i & 4 ? 1.0f : -1.0f) * half.z());
  }
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 3, 7}, {1, 7, 5}};
  mesh.materials.assign(mesh.triangles.size(), material);
  return mesh;
}

/// A sphere about the origin, of 2 * n * n quadrilaterals whose corners lie on it.
inline TriangleMesh sphere(float radius, std::uint32_t n, std::uint16_t material = 0) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i <= n; ++i) {
    for (std::uint32_t j = 0; j <= 2 * n; ++j) {
      const auto polar = static_cast<float>(kPi * i / n), azimuth = static_cast<float>(kPi * j / n);
      mesh.vertices.emplace_back(radius * std::sin(polar) * std::cos(azimuth),
                                 radius * std::sin(polar) * std::sin(azimuth), radius * std::cos(polar));
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < 2 * n; ++j) {
      const std::uint32_t a = i * (2 * n + 1) + j, b = a + 2 * n + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  }
  mesh.materials.assign(mesh.triangles.size(), material);
  return mesh;
}

/// A scene of meshes that each stand in one place.
inline Scene sceneOf(std::vector<TriangleMesh> meshes, std::vector<Material> materials = {{40, 0.5f}}) {
  Scene scene;
  scene.materials = std::move(materials);
  scene.meshes = std::move(meshes);
  for (std::uint32_t i = 0; i < scene.meshes.size(); ++i) {
    scene.objects.push_back({i, Eigen::Affine3f::Identity()});
  }
  return scene;
}

/// An HDL-64E that neither errs nor misses what is in its range.
inline LidarOptions perfectLidar() {
  LidarOptions options;
  options.own_vehicle.setEmpty();
  options.range_noise_m = 0.0;
  options.beam_range_offset_m = 0.0;
  options.angle_jitter_rad = 0.0;
  options.beam_divergence_rad = 0.0;
  options.detection_range_m = 1e4;
  options.power_fluctuation = 0.0;
  options.dropout_share = 0.0;
  return options;
}

/// A LiDAR at kSensorHeight_m above the origin that drives along x from there: stamps 0, 0.1 s and so on.
inline VehicleMotion straightDrive(int scans, double speed_mps) {
  VehicleMotion motion;
  for (int scan = 0; scan < scans; ++scan) {
    motion.stamps_s.push_back(0.1 * scan);
    motion.T_scene_lidar.emplace_back(Eigen::Translation3d(0.1 * scan * speed_mps, 0.0, kSensorHeight_m));
  }
  return motion;
}

}  // namespace saw_ndt
