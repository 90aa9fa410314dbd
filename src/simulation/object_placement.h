#pragma once

#include "simulation/drive_options.h"
#include "simulation/route.h"
#include "simulation/scene.h"
#include "simulation/scene_description.h"
#include "simulation/terrain.h"

namespace saw_ndt {

/// Adds the objects of a description's rows to a scene, none on the road of another stretch of the route or within
/// another object.
void placeObjects(const SceneDescription& description, const Route& route, const Terrain& terrain,
                  const DriveOptions& options, Scene& scene);

}  // namespace saw_ndt
