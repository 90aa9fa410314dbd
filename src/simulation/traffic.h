#pragma once

#include <memory>

#include "simulation/drive_options.h"
#include "simulation/route.h"
#include "simulation/scene.h"
#include "simulation/scene_description.h"
#include "simulation/terrain.h"
#include "simulation/vehicle_motion.h"

namespace saw_ndt {

/// Adds the moving objects of a drive to a scene; they move at constant speed along the route, beside the vehicle.
void addTraffic(const SceneDescription& description, const std::shared_ptr<const Route>& route,
                const std::shared_ptr<const Terrain>& terrain, const std::shared_ptr<const VehicleMotion>& motion,
                const DriveOptions& options, Scene& scene);

}  // namespace saw_ndt
