#include "simulation/scene_builder.h"

#include "simulation/object_placement.h"
#include "simulation/scene_materials.h"
#include "simulation/traffic.h"

namespace saw_ndt {

Scene buildScene(const SceneDescription& description, const std::shared_ptr<const Route>& route,
                 const std::shared_ptr<const Terrain>& terrain, const std::shared_ptr<const VehicleMotion>& motion,
                 const DriveOptions& options) {
  options.check();
  Scene scene;
  scene.materials = sceneMaterials();
  scene.objects.push_back({static_cast<std::uint32_t>(scene.meshes.size()), Eigen::Affine3f::Identity()});
  scene.meshes.push_back(terrain->mesh(materialIndex(SceneMaterial::ASPHALT), materialIndex(SceneMaterial::PAVEMENT),
                                       materialIndex(SceneMaterial::GRASS)));
  placeObjects(description, *route, *terrain, options, scene);
  addTraffic(description, route, terrain, motion, options, scene);
  return scene;
}

}  // namespace saw_ndt
