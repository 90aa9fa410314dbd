#pragma once

#include "simulation/scene.h"

namespace saw_ndt {

/// Throws std::invalid_argument that names the field, its index and what is wrong; see RayCaster.
void checkScene(const Scene& scene);

/// Throws std::invalid_argument where the pose of moving object `index` is not finite.
void checkMovingPose(const Eigen::Isometry3d& T_scene_object, std::size_t index);

}  // namespace saw_ndt
