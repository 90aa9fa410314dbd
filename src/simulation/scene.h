#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace saw_ndt {

/// What a surface is made of.
struct Material {
  std::uint16_t semantic_class = 0;  ///< of SemanticKITTI
  float reflectivity = 0.5f;  ///< share of the light that a diffuse surface sends back; above 1: retro-reflective
};

/// A surface of triangles, each of one material; both sides reflect.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;                ///< metres
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into vertices
  std::vector<std::uint16_t> materials;                 ///< index into Scene::materials, one a triangle
};

/// Adds the triangles of one mesh to another.
void append(const TriangleMesh& part, TriangleMesh& whole);

/// A mesh that stands somewhere; many may share one mesh.
struct PlacedObject {
  std::uint32_t mesh = 0;  ///< index into Scene::meshes
  Eigen::Affine3f T_scene_object = Eigen::Affine3f::Identity();
};

/// A mesh that moves.
struct MovingObject {
  std::uint32_t mesh = 0;                                           ///< index into Scene::meshes
  std::function<Eigen::Isometry3d(double stamp_s)> T_scene_object;  ///< where it is at a time (s)
};

/// What a LiDAR sees on one drive: x and y level, z up, metres; the ground lies in it as an object like any other.
struct Scene {
  std::vector<Material> materials;
  std::vector<TriangleMesh> meshes;
  std::vector<PlacedObject> objects;
  std::vector<MovingObject> moving_objects;
};

}  // namespace saw_ndt
