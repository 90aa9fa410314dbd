#pragma once

#include <memory>

#include "simulation/drive_options.h"
#include "simulation/route.h"
#include "simulation/scene.h"
#include "simulation/scene_description.h"
#include "simulation/terrain.h"
#include "simulation/vehicle_motion.h"

namespace saw_ndt {

/// Lays a scene along a route: ground, objects and, for one drive, parked cars and traffic.
/// @param route, terrain, motion  of the drive; the scene's moving objects keep them
Scene buildScene(const SceneDescription& description, const std::shared_ptr<const Route>& route,
                 const std::shared_ptr<const Terrain>& terrain, const std::shared_ptr<const VehicleMotion>& motion,
                 const DriveOptions& options);

}  // namespace saw_ndt
