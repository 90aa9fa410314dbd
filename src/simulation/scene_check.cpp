#include "simulation/scene_check.h"

#include <Eigen/LU>
#include <cmath>
#include <stdexcept>
#include <string>

namespace saw_ndt {
namespace {

[[noreturn]] void refuse(const std::string& list, std::size_t index, const std::string& reason) {
  throw std::invalid_argument(list + "[" + std::to_string(index) + "]" + reason);
}

void checkMesh(const TriangleMesh& mesh, std::size_t index, std::size_t material_count) {
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (!mesh.vertices[i].allFinite()) refuse("meshes", index, ".vertices[" + std::to_string(i) + "]: must be finite");
  }
  if (mesh.materials.size() != mesh.triangles.size()) {
    refuse("meshes", index,
           ".materials.size() = " + std::to_string(mesh.materials.size()) + ": must be one a triangle, " +
               std::to_string(mesh.triangles.size()));
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t vertex : mesh.triangles[i]) {
      if (vertex >= mesh.vertices.size()) {
        refuse("meshes", index,
               ".triangles[" + std::to_string(i) + "] has vertex " + std::to_string(vertex) + ": must be below " +
                   std::to_string(mesh.vertices.size()));
      }
    }
    if (mesh.materials[i] >= material_count) {
      refuse("meshes", index,
             ".materials[" + std::to_string(i) + "] = " + std::to_string(mesh.materials[i]) + ": must be below " +
                 std::to_string(material_count));
    }
  }
}

void checkMeshIndex(const std::string& list, std::size_t index, std::uint32_t mesh, std::size_t mesh_count) {
  if (mesh < mesh_count) return;
  refuse(list, index, ".mesh = " + std::to_string(mesh) + ": must be below " + std::to_string(mesh_count));
}

}  // namespace

void checkScene(const Scene& scene) {
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const float reflectivity = scene.materials[i].reflectivity;
    if (!(reflectivity >= 0.0F && std::isfinite(reflectivity))) {
      refuse("materials", i, ".reflectivity = " + std::to_string(reflectivity) + ": must be 0 or more");
    }
  }
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) checkMesh(scene.meshes[i], i, scene.materials.size());
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    checkMeshIndex("objects", i, scene.objects[i].mesh, scene.meshes.size());
    const Eigen::Affine3f& T = scene.objects[i].T_scene_object;
    // Norm-free singularity test: the inverse exists in float where the normals need it.
    if (!T.affine().allFinite() || !Eigen::Matrix3f(T.linear().inverse()).allFinite()) {
      refuse("objects", i, ".T_scene_object: must be finite and invertible");
    }
  }
  for (std::size_t i = 0; i < scene.moving_objects.size(); ++i) {
    checkMeshIndex("moving_objects", i, scene.moving_objects[i].mesh, scene.meshes.size());
    if (!scene.moving_objects[i].T_scene_object) refuse("moving_objects", i, ".T_scene_object: must be set");
  }
}

void checkMovingPose(const Eigen::Isometry3d& T_scene_object, std::size_t index) {
  if (!T_scene_object.affine().allFinite()) refuse("moving_objects", index, ".T_scene_object: must be finite");
}

}  // namespace saw_ndt
