#include "simulation/object_meshes.h"

#include <gtest/gtest.h>

#include "expect_throws.h"
#include "simulation/scene_materials.h"

namespace saw_ndt {
namespace {

TEST(ObjectMeshes, EveryKindHasAboutTheSizeAskedFor) {
  const ObjectSize size{4.0, 2.0, 3.0};
  for (const std::string& kind : objectKinds()) {
    const TriangleMesh mesh = makeObjectMesh(kind, size, false, 5);
    ASSERT_GE(mesh.triangles.size(), 10U) << kind;
    ASSERT_EQ(mesh.triangles.size(), mesh.materials.size()) << kind;
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
      ASSERT_TRUE(vertex.allFinite()) << kind;
      box.extend(vertex);
    }
    // Roofs, arms, porches and leaves reach out by less than 1.7 m; feet go into the ground by a metre at most.
    EXPECT_GE(box.min().x(), -3.7f) << kind;
    EXPECT_LE(box.max().x(), 3.7f) << kind;
    EXPECT_GE(box.min().y(), -2.7f) << kind;
    EXPECT_LE(box.max().y(), 2.7f) << kind;
    EXPECT_GE(box.min().z(), -1.0f) << kind;
    EXPECT_GE(box.max().z(), 0.9f * 3.0f) << kind;
    EXPECT_LE(box.max().z(), 3.9f) << kind;
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t index : triangle) ASSERT_LT(index, mesh.vertices.size()) << kind;
    }
  }
}

TEST(ObjectMeshes, ACeilingLeavesTheWayBelowItFree) {
  for (const Eigen::Vector3f& vertex : makeObjectMesh("ceiling", {10.0, 9.0, 5.0}, false, 1).vertices) {
    EXPECT_GE(vertex.z(), 4.5f);
    EXPECT_LE(vertex.z(), 5.0f);
  }
}

TEST(ObjectMeshes, TheSeedDecidesTheDetails) {
  const ObjectSize size{3.0, 3.0, 5.0};
  const auto verticesOf = [&](std::uint64_t seed) { return makeObjectMesh("tree", size, false, seed).vertices; };
  EXPECT_EQ(verticesOf(1), verticesOf(1));
  EXPECT_NE(verticesOf(1), verticesOf(2));
}

TEST(ObjectMeshes, WhatMovesHasClassesOfItsOwn) {
  const std::vector<Material> materials = sceneMaterials();
  ASSERT_EQ(materials.size(), 2U * static_cast<std::size_t>(SceneMaterial::COUNT));
  const auto classOf = [&](const std::string& kind, bool moving) {
    return materials.at(makeObjectMesh(kind, {4.0, 1.8, 1.5}, moving, 1).materials.front()).semantic_class;
  };
  EXPECT_EQ(classOf("car", false), 10);
  EXPECT_EQ(classOf("car", true), 252);
  EXPECT_EQ(classOf("truck", true), 258);
  EXPECT_EQ(classOf("person", false), 30);
  EXPECT_EQ(classOf("person", true), 254);
}

TEST(ObjectMeshes, AnUnknownKindIsNamed) {
  expectThrows<std::invalid_argument>([] { makeObjectMesh("dragon", {}, false, 1); }, {"dragon"});
}

}  // namespace
}  // namespace saw_ndt
