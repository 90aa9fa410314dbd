#include "simulation/scene_materials.h"

namespace saw_ndt {
namespace {

/// The class of a moving thing in SemanticKITTI.
std::uint16_t movingClass(std::uint16_t standing) {
  switch (standing) {
    case 10:
      return 252;
    case 18:
      return 258;
    case 30:
      return 254;
    default:
      return standing;
  }
}

}  // namespace

std::vector<Material> sceneMaterials() {
  // Class and reflectivity near 905 nm, in the order of SceneMaterial. Panes let nearly everything through or send it
  // elsewhere.
  std::vector<Material> materials = {
      {40, 0.20f}, {48, 0.30f}, {72, 0.35f},                                          // asphalt, pavement, grass
      {50, 0.40f}, {50, 0.02f}, {50, 0.25f},                                          // facade, its windows, roof
      {52, 0.40f}, {51, 0.35f},                                                       // concrete, wood
      {70, 0.35f}, {71, 0.30f},                                                       // leaf, bark
      {80, 0.45f}, {51, 0.50f}, {81, 2.00f},                                          // pole, guard rail, sign
      {10, 0.50f}, {10, 0.08f}, {10, 0.003f}, {10, 0.05f}, {18, 0.50f}, {30, 0.35f},  // truck, person
  };
  const std::size_t count = materials.size();
  for (std::size_t i = 0; i < count; ++i) {
    materials.push_back({movingClass(materials[i].semantic_class), materials[i].reflectivity});
  }
  return materials;
}

}  // namespace saw_ndt
