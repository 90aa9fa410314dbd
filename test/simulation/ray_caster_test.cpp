#include "simulation/ray_caster.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <vector>

#include "expect_throws.h"
#include "simple_scene.h"

namespace saw_ndt {
namespace {

std::vector<RayHit> cast(const RayCaster& caster, const std::vector<Ray>& rays) {
  std::vector<RayHit> hits(rays.size());
  caster.cast(rays.data(), rays.size(), 100.0F, hits.data());
  return hits;
}

Ray rayAlongX(float z, float time_share = 0.0F) { return {{0, 0, z}, Eigen::Vector3f::UnitX(), time_share}; }

TEST(RayCaster, HitsTheNearestOfMeshesInstancesAndMovingObjects) {
  Scene scene;
  scene.materials = {{40, 0.2F}, {50, 0.4F}, {10, 0.1F}};
  scene.meshes = {rectangle({50, -5, -5}, {0, 10, 0}, {0, 0, 10}, 0), block({1, 1, 1}, 1), block({1, 1, 1}, 2)};
  scene.objects.push_back({0, Eigen::Affine3f::Identity()});
  // Twice as long along x, its near side at 18; and another one off to the side.
  scene.objects.push_back({1, Eigen::Translation3f(20, 0, 0) * Eigen::Scaling(2.0F, 1.0F, 1.0F)});
  scene.objects.push_back({1, Eigen::Affine3f(Eigen::Translation3f(0, 30, 0))});
  scene.moving_objects.push_back(
      {2, [](double stamp_s) { return Eigen::Isometry3d(Eigen::Translation3d(10.0 + stamp_s, 0, 3)); }});
  RayCaster caster(scene);
  caster.setTimeSpan(0.0, 2.0);

  const std::vector<RayHit> hits = cast(caster, {rayAlongX(0),
                                                 rayAlongX(3, 0.0F),
                                                 rayAlongX(3, 0.5F),
                                                 rayAlongX(4.5F),
                                                 {{0, 0, 0}, -Eigen::Vector3f::UnitX(), 0.0F}});
  EXPECT_FLOAT_EQ(hits[0].range_m, 18.0F);
  EXPECT_EQ(hits[0].material, 1);
  EXPECT_FLOAT_EQ(hits[1].range_m, 9.0F);
  EXPECT_FLOAT_EQ(hits[2].range_m, 10.0F);
  EXPECT_EQ(hits[2].material, 2);
  EXPECT_FLOAT_EQ(hits[3].range_m, 50.0F);
  EXPECT_EQ(hits[3].material, 0);
  for (int i = 0; i < 4; ++i) EXPECT_LT((hits[i].normal + Eigen::Vector3f::UnitX()).norm(), 1e-6F) << i;
  EXPECT_FALSE(hits[4].isHit());
}

TEST(RayCaster, AScaledInstanceHasTheNormalsOfItsShape) {
  // A slope of 45 degrees, squeezed to half its height.
  Scene scene = sceneOf({rectangle({0, -5, 0}, {10, 0, 10}, {0, 10, 0})});
  scene.objects[0].T_scene_object = Eigen::Scaling(1.0F, 1.0F, 0.5F);
  scene.objects.push_back(scene.objects[0]);  // now an instance
  const std::vector<RayHit> hits = cast(RayCaster(scene), {rayAlongX(2)});
  EXPECT_FLOAT_EQ(hits[0].range_m, 4.0F);
  EXPECT_LT((hits[0].normal - Eigen::Vector3f(-1, 0, 2).normalized()).norm(), 1e-6F);
}

TEST(RayCaster, AnEmptySceneIsMissed) {
  EXPECT_FALSE(cast(RayCaster(Scene()), {rayAlongX(0)})[0].isHit());
  Scene scene = sceneOf({TriangleMesh(), TriangleMesh()});
  scene.objects.push_back(scene.objects[0]);
  scene.moving_objects.push_back({1, [](double) { return Eigen::Isometry3d::Identity(); }});
  RayCaster caster(scene);
  caster.setTimeSpan(0.0, 0.1);
  EXPECT_FALSE(cast(caster, {rayAlongX(0)})[0].isHit());
  EXPECT_FALSE(cast(RayCaster(sceneOf({ground(-101)})), {{{0, 0, 0}, -Eigen::Vector3f::UnitZ(), 0}})[0].isHit());
}

TEST(RayCaster, NamesWhatIsWrongInAScene) {
  const auto expectRefused = [](const std::function<void(Scene&)>& spoil, std::initializer_list<std::string> parts) {
    Scene scene = sceneOf({ground(), block({1, 1, 1})});
    spoil(scene);
    expectThrows<std::invalid_argument>([&] { RayCaster caster(scene); }, parts);
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  expectRefused([&](Scene& s) { s.meshes[1].vertices[3].y() = nan; }, {"meshes[1].vertices[3]", "finite"});
  expectRefused([](Scene& s) { s.meshes[1].triangles[2][0] = 8; }, {"meshes[1].triangles[2] has vertex 8", "below 8"});
  expectRefused([](Scene& s) { s.meshes[0].materials[1] = 7; }, {"meshes[0].materials[1] = 7", "below 1"});
  expectRefused([](Scene& s) { s.meshes[0].materials.pop_back(); }, {"meshes[0].materials.size() = 1"});
  expectRefused([](Scene& s) { s.objects[1].mesh = 2; }, {"objects[1].mesh = 2", "below 2"});
  expectRefused([](Scene& s) { s.objects[0].T_scene_object.linear().setZero(); }, {"objects[0].T_scene_object"});
  expectRefused([&](Scene& s) { s.objects[0].T_scene_object(0, 3) = nan; }, {"objects[0].T_scene_object"});
  expectRefused([](Scene& s) { s.moving_objects.push_back({0, {}}); }, {"moving_objects[0].T_scene_object"});
  expectRefused([](Scene& s) { s.materials[0].reflectivity = -1; }, {"materials[0].reflectivity = -1"});

  Scene scene = sceneOf({ground()});
  scene.moving_objects.push_back({0, [](double) { return Eigen::Isometry3d(Eigen::Translation3d(NAN, 0, 0)); }});
  RayCaster caster(scene);
  expectThrows<std::invalid_argument>([&] { caster.setTimeSpan(0, 1); }, {"moving_objects[0]", "finite"});
}

}  // namespace
}  // namespace saw_ndt
