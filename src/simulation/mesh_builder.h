#pragma once

#include <functional>

#include "simulation/random_numbers.h"
#include "simulation/scene.h"
#include "simulation/scene_materials.h"

namespace saw_ndt {

/// Adds simple shapes to a mesh; lengths in metres.
class MeshBuilder {
 public:
  /// @param moving  materials are those of moving things
  explicit MeshBuilder(bool moving) : moving_(moving) {}

  void addTriangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                   SceneMaterial material);
  /// Corners in order around the quad.
  void addQuad(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, const Eigen::Vector3d& d,
               SceneMaterial material);
  /// A box between two corners, its bottom left open.
  void addBox(const Eigen::Vector3d& low, const Eigen::Vector3d& high, SceneMaterial material);
  /// An upright cylinder, or a cone where the radii differ, with a lid.
  void addColumn(const Eigen::Vector3d& foot, double radius_low, double radius_high, double height,
                 SceneMaterial material);
  /// A level cylinder along y.
  void addWheel(const Eigen::Vector3d& centre, double radius, double width, SceneMaterial material);
  /// The outline (x, z), counter-clockwise seen from -y, drawn out from y = -half_width to half_width.
  void addExtrusion(const std::vector<Eigen::Vector2d>& outline, double half_width, SceneMaterial material);
  /// Small triangles in random directions at points that `draw` gives.
  void addLeaves(int count, double leaf_m, const std::function<Eigen::Vector3d(SceneRandom&)>& draw,
                 SceneRandom& random);

  TriangleMesh take() { return std::move(mesh_); }

 private:
  bool moving_;
  TriangleMesh mesh_;
};

}  // namespace saw_ndt
