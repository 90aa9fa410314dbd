#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "simulation/scene.h"

namespace saw_ndt {

/// The kinds of object that makeObjectMesh() knows.
const std::vector<std::string>& objectKinds();

/// Extent of an object (m).
struct ObjectSize {
  double length_m = 1.0;  ///< along x, the direction of the road
  double width_m = 1.0;   ///< along y
  double height_m = 1.0;  ///< along z, from the ground
};

/// A mesh of an object that stands on z = 0 around the origin.
/// @param kind    one of objectKinds(); for another std::invalid_argument
/// @param moving  its materials are of the classes of moving things
/// @param seed    draws the details, such as leaves and windows
TriangleMesh makeObjectMesh(const std::string& kind, const ObjectSize& size, bool moving, std::uint64_t seed);

}  // namespace saw_ndt
