#pragma once

#include "saw_ndt/simulation/drive_options.h"
#include "saw_ndt/simulation/route.h"
#include "saw_ndt/simulation/scene.h"
#include "saw_ndt/simulation/scene_description.h"
#include "saw_ndt/simulation/terrain.h"

namespace saw_ndt {

/// Adds the objects of a description's rows to a scene, none on the road of another stretch of the route or within
/// another object.
void placeObjects(const SceneDescription& description, const Route& route, const Terrain& terrain,
                  const DriveOptions& options, Scene& scene);

}  // namespace saw_ndt
