#pragma once

#include <cstdint>
#include <vector>

#include "simulation/scene.h"

namespace saw_ndt {

/// Materials of made scenes: positions in sceneMaterials().
enum class SceneMaterial : std::uint16_t {
  ASPHALT,
  PAVEMENT,
  GRASS,
  FACADE,
  FACADE_GLASS,
  ROOF,
  CONCRETE,
  WOOD,
  LEAF,
  BARK,
  METAL_POLE,
  GUARD_RAIL,
  SIGN_PLATE,
  CAR_PAINT,
  CAR_PAINT_DARK,
  CAR_GLASS,
  TYRE,
  TRUCK_BODY,
  CLOTH,
  COUNT
};

/// The index of a material; with `moving`, of its twin whose class is that of a moving thing.
constexpr std::uint16_t materialIndex(SceneMaterial material, bool moving = false) {
  return static_cast<std::uint16_t>(static_cast<std::uint16_t>(material) +
                                    (moving ? static_cast<std::uint16_t>(SceneMaterial::COUNT) : 0));
}

/// All materials, those of moving things after those that stand.
std::vector<Material> sceneMaterials();

}  // namespace saw_ndt
