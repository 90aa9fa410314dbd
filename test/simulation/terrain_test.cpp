#include "simulation/terrain.h"

#include <gtest/gtest.h>

#include <cmath>

namespace saw_ndt {
namespace {

SceneDescription smoothScene() {
  SceneDescription scene;
  scene.road = {4.0, 2.0, 0.15, 1.5};
  scene.terrain.undulation_m = 0.0;
  scene.terrain.roughness_m = 0.0;
  return scene;
}

Route slopedRoute() { return Route::throughPositions({{0, 0, 10}, {200, 0, 20}}); }

TEST(Terrain, FollowsTheWayAndStepsUpAtTheKerb) {
  const Route route = slopedRoute();
  SceneDescription scene = smoothScene();
  scene.terrain.bank_height_m = 2.0;
  scene.terrain.bank_width_m = 5.0;
  const Terrain terrain(route, scene, 7);
  // 1 cm of the road's own unevenness, at most sqrt(3) times that.
  const double unevenness = 0.018;
  EXPECT_NEAR(terrain.height({100.0, 0.0}), 15.0, unevenness);
  EXPECT_NEAR(terrain.height({100.0, 3.9}), 15.0, unevenness);
  EXPECT_NEAR(terrain.height({100.0, 4.2}) - terrain.height({100.0, 3.99}), 0.15, 0.005);
  EXPECT_NEAR(terrain.height({100.0, 4.0 + 1.5 + 5.0}), 15.0 + 0.15 + 2.0, unevenness);
  EXPECT_NEAR(terrain.edgeDistance({100.0, -5.0}), 3.0, 1e-9);
  EXPECT_EQ(terrain.edgeDistance({100.0, 5000.0}), Terrain::kExtent_m);
}

TEST(Terrain, TheMeshLiesOnTheGroundAndIsNamedByWhereItIs) {
  const Route route = slopedRoute();
  SceneDescription scene = smoothScene();
  scene.terrain.undulation_m = 0.3;
  scene.terrain.roughness_m = 0.02;
  const Terrain terrain(route, scene, 7);
  const TriangleMesh mesh = terrain.mesh(1, 2, 3);
  ASSERT_EQ(mesh.triangles.size(), mesh.materials.size());
  ASSERT_GT(mesh.triangles.size(), 50000U);
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 97) {
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    double longest = 0.0;
    for (const std::uint32_t index : mesh.triangles[i]) {
      ASSERT_LT(index, mesh.vertices.size());
      const Eigen::Vector3d vertex = mesh.vertices[index].cast<double>();
      middle += vertex.head<2>() / 3.0;
      longest = std::max(longest, (mesh.vertices[index] - mesh.vertices[mesh.triangles[i][0]]).norm() * 1.0);
      // A block looks at the stations near its centre, a point at those near itself: far out they differ a little.
      if (terrain.edgeDistance(vertex.head<2>()) < 10.0) {
        EXPECT_NEAR(vertex.z(), terrain.height(vertex.head<2>()), 2e-3);
      }
    }
    const double edge_m = terrain.edgeDistance(middle);
    const std::uint16_t expected = edge_m < 0.0 ? 1 : edge_m < 1.5 ? 2 : 3;
    const bool near_a_border = std::abs(edge_m) < longest || std::abs(edge_m - 1.5) < longest;
    if (!near_a_border) {
      EXPECT_EQ(mesh.materials[i], expected) << edge_m;
    }
  }
}

}  // namespace
}  // namespace saw_ndt
